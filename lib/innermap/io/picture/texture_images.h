// The images of a texture, one or a set of UDIM tiles, looked up by texture coordinates.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "innermap/core/setting.h"
#include "innermap/core/vec3.h"
#include "innermap/io/picture/image_file.h"

namespace innermap {

// Column and row of a UDIM tile: whole parts of u and v.
using UdimTile = std::pair<int, int>;

struct TextureImageSettings {
  ColourSpace colourSpace = ColourSpace::automatic;
  Wrap wrap = Wrap::repeat;  // of a single image
};

std::vector<Setting> describe(TextureImageSettings& settings);

// Whether the path has "<UDIM>" in it, which stands for the number of each tile.
bool isTiled(const std::string& path);

// Immutable; copies share their data; safe from any number of threads.
class TextureImages {
 public:
  // tiles: that are read when the path has "<UDIM>" in it; not used otherwise. Throws as readImage
  // does.
  TextureImages(const std::string& path, const std::vector<UdimTile>& tiles,
                const TextureImageSettings& settings = {});

  // The linear colour at uv, averaged over about the parallelogram that a and b span about it (in
  // texture coordinates): trilinear in pyramids of the images, anisotropic. Black where no tile is.
  Vec3 at(const Vec2& uv, const Vec2& a, const Vec2& b) const;

  // Of the image, or of the last tile.
  int width() const;  // pixels; 0 when there is none
  int height() const;
  const std::string& colourSpace() const;  // as in ImageFile
  const std::string& channels() const;
  std::size_t count() const;
  const std::vector<std::string>& notes() const;  // of all, with their paths before them

 private:
  struct Data;
  std::shared_ptr<const Data> data_;
};

// Bytes that reading takes; of UDIM tiles, the first times their number.
std::uint64_t textureImageMemory(const std::string& path, const std::vector<UdimTile>& tiles);

}  // namespace innermap
