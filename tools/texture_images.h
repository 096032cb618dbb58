// The images of a texture: one, or a set of UDIM tiles.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "context.h"
#include "innermap/io/picture/image_file.h"
#include "innermap/mesh/mesh.h"

namespace innermap::tool {

struct TextureImageOptions {
  std::string path;  // with "<UDIM>" in it: a tile for each whole part of (u, v)
  ColourSpace colourSpace = ColourSpace::automatic;
  Wrap wrap = Wrap::repeat;
};

// Immutable; safe from any number of threads.
class TextureImages {
 public:
  // Reads the image, or those tiles that triangles with coordinates lie in. Notes go to the
  // context; the report's "texture" gets what was read. Throws as readImage does; DataError for
  // coordinates that no tile can have.
  TextureImages(const TextureImageOptions& options, const Mesh& mesh, Context& context);

  // See Image::at. Black where a tile is not there.
  Vec3 at(const Vec2& uv, const Vec2& a, const Vec2& b) const;

 private:
  void read(const std::string& path, const TextureImageOptions& options, std::pair<int, int> tile,
            Wrap wrap, Context& context);

  bool tiled_ = false;
  std::map<std::pair<int, int>, Image> tiles_;
};

// Bytes that reading takes; of UDIM tiles, the first times their number.
std::uint64_t textureImageMemory(const TextureImageOptions& options, const Mesh& mesh);

}  // namespace innermap::tool
