#include <fmt/format.h>

#include <cmath>
#include <set>

#include "innermap/core/error.h"
#include "innermap/texture/solid_texture.h"

namespace innermap {

std::vector<std::pair<int, int>> udimTiles(const Mesh& mesh) {
  constexpr int kColumns = 10, kRows = 900;  // 1001 to 9999
  std::set<std::pair<int, int>> tiles;
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
  return {tiles.begin(), tiles.end()};
}

}  // namespace innermap
