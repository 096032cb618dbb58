#include "texture_images.h"

#include <fmt/format.h>

#include <cmath>
#include <set>

#include "innermap/core/error.h"

namespace innermap::tool {
namespace {

constexpr const char* kMark = "<UDIM>";
constexpr int kColumns = 10, kRows = 900;  // 1001 to 9999

using Tile = std::pair<int, int>;

std::string tilePath(std::string path, const Tile& tile) {
  const std::string number = std::to_string(1001 + tile.first + kColumns * tile.second);
  return path.replace(path.find(kMark), std::string(kMark).size(), number);
}

// By the triangles' middles: corners may lie on a tile's border.
std::set<Tile> tilesOf(const Mesh& mesh) {
  std::set<Tile> tiles;
  for (const Triangle& t : mesh.uvTriangles) {
    if (t[0] < 0 || t[1] < 0 || t[2] < 0) continue;
    Vec2 middle;
    for (const int uv : t) {
      middle.x += mesh.uvs[uv].x / 3;
      middle.y += mesh.uvs[uv].y / 3;
    }
    if (!std::isfinite(middle.x) || !std::isfinite(middle.y)) continue;
    const double column = std::floor(middle.x), row = std::floor(middle.y);
    if (!(column >= 0 && column < kColumns && row >= 0 && row < kRows))
      throw DataError(
          fmt::format("{}: has texture coordinates near ({:.4g}, {:.4g}), where no UDIM tile is; "
                      "tiles lie from 0 to 10 along u and above 0 along v",
                      mesh.name, middle.x, middle.y));
    tiles.emplace(static_cast<int>(column), static_cast<int>(row));
  }
  return tiles;
}

bool isTiled(const std::string& path) { return path.find(kMark) != std::string::npos; }

}  // namespace

void TextureImages::read(const std::string& path, const TextureImageOptions& options, Tile tile,
                         Wrap wrap, Context& context) {
  ImageSettings settings;
  settings.colourSpace = options.colourSpace;
  settings.maxMemory = context.maxMemory();
  settings.progress = context.progress();
  ImageFile file = readImage(path, settings);
  for (const std::string& note : file.notes) context.note(path + ": " + note);
  Report& report = context.report();
  report.set("texture.colour_space", file.colourSpace);
  report.set("texture.channels", file.channels);
  report.set("texture.width", static_cast<std::int64_t>(file.pixels.width));
  report.set("texture.height", static_cast<std::int64_t>(file.pixels.height));
  tiles_.emplace(tile, Image(std::move(file.pixels), wrap, context.progress()));
}

TextureImages::TextureImages(const TextureImageOptions& options, const Mesh& mesh, Context& context)
    : tiled_(isTiled(options.path)) {
  context.report().set("texture.image", options.path);
  if (!tiled_) {
    read(options.path, options, {0, 0}, options.wrap, context);
    return;
  }
  for (const Tile& tile : tilesOf(mesh))
    read(tilePath(options.path, tile), options, tile, Wrap::clamp, context);
  context.report().set("texture.tiles", static_cast<std::int64_t>(tiles_.size()));
}

Vec3 TextureImages::at(const Vec2& uv, const Vec2& a, const Vec2& b) const {
  if (!tiled_) return tiles_.begin()->second.at(uv, a, b);
  const double column = std::floor(uv.x), row = std::floor(uv.y);
  if (!(column >= 0 && column < kColumns && row >= 0 && row < kRows)) return {};
  const auto tile = tiles_.find({static_cast<int>(column), static_cast<int>(row)});
  return tile == tiles_.end() ? Vec3{} : tile->second.at({uv.x - column, uv.y - row}, a, b);
}

std::uint64_t textureImageMemory(const TextureImageOptions& options, const Mesh& mesh) {
  if (!isTiled(options.path)) return imageMemory(options.path);
  const std::set<Tile> tiles = tilesOf(mesh);
  return tiles.empty() ? 0 : tiles.size() * imageMemory(tilePath(options.path, *tiles.begin()));
}

}  // namespace innermap::tool
