#include <gtest/gtest.h>

#include <limits>

#include "innermap/core/error.h"
#include "innermap/texture/solid_texture.h"

namespace innermap {
namespace {

// A triangle for each place, small about it.
Mesh trianglesAt(const std::vector<Vec2>& places) {
  Mesh mesh{.name = "places"};
  for (const Vec2& p : places) {
    const int first = static_cast<int>(mesh.uvs.size());
    mesh.uvs.insert(mesh.uvs.end(), {{p.x - 0.1, p.y}, {p.x + 0.1, p.y - 0.1}, {p.x, p.y + 0.1}});
    mesh.uvTriangles.push_back({first, first + 1, first + 2});
  }
  return mesh;
}

TEST(TextureLookup, TilesAreThoseOfTheTrianglesMiddles) {
  const std::vector<std::pair<int, int>> expected{{0, 0}, {1, 0}, {9, 12}};
  // The first and the last reach over their tile's border.
  EXPECT_EQ(udimTiles(trianglesAt({{9.95, 12.5}, {0.5, 0.5}, {1.5, 0.05}, {0.2, 0.95}})), expected);
}

TEST(TextureLookup, TrianglesWithoutCoordinatesHaveNoTile) {
  Mesh mesh = trianglesAt({{0.5, 0.5}, {3.5, 0.5}, {5.5, 0.5}});
  mesh.uvTriangles[1][2] = -1;
  mesh.uvs[static_cast<std::size_t>(mesh.uvTriangles[2][0])].x =
      std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(udimTiles(mesh).size(), 1u);
  EXPECT_TRUE(udimTiles(Mesh()).empty());
}

TEST(TextureLookup, CoordinatesWhereNoTileIsAreRefused) {
  for (const Vec2& place : {Vec2{-0.5, 0.5}, Vec2{10.5, 0.5}, Vec2{0.5, -0.5}, Vec2{0.5, 900.5}})
    EXPECT_THROW(udimTiles(trianglesAt({place})), DataError);
}

}  // namespace
}  // namespace innermap
