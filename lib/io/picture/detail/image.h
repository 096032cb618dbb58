// Images that are looked up by texture coordinates, filtered over what a sample stands for.
#pragma once

#include <memory>

#include "innermap/core/vec3.h"
#include "innermap/io/pictures.h"

namespace innermap {

// An image with its pyramid of halved copies. Immutable; copies share their data; safe from any
// number of threads.
class Image {
 public:
  // Throws DataError when the sizes disagree or are not positive. Takes a third more memory than
  // the pixels.
  explicit Image(Pixels pixels, Wrap wrap = Wrap::repeat);

  int width() const;
  int height() const;

  // The colour at (u, v), where (0, 0) is the image's lower left corner and (1, 1) its upper right
  // one; bilinear between the pixels' centres. Black where u or v is not finite.
  Vec3 at(const Vec2& uv) const;

  // The mean over about the parallelogram that a and b span about uv (in texture coordinates): what
  // a sample sees whose neighbours stand one a, or one b, away. Trilinear in the pyramid, up to 16
  // times along the longer axis of the parallelogram's ellipse (Heckbert, "Fundamentals of Texture
  // Mapping and Image Warping", 1989).
  Vec3 at(const Vec2& uv, const Vec2& a, const Vec2& b) const;

 private:
  struct Level;
  struct Data;
  Vec3 bilinear(const Level& level, const Vec2& uv) const;
  Vec3 trilinear(double level, const Vec2& uv) const;

  std::shared_ptr<const Data> data_;
};

}  // namespace innermap
