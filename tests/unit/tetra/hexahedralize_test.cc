#include "innermap/tetra/hexahedralize.h"

#include <gtest/gtest.h>

#include "mesh/shapes.h"

namespace innermap {
namespace {

double enclosedVolume(const CellMesh& mesh) {
  return signedVolume(mesh.vertices, boundaryTriangles(mesh));
}

HexahedralizeSettings across(int blocks, int pieces) {
  HexahedralizeSettings settings;
  settings.polycube.blocks = blocks;
  settings.pieces = pieces;
  return settings;
}

TEST(HexahedralizeNightly, ReachesAcrossThinPartsAndCavities) {
  Mesh shell = shapes::icosphere(4);
  const int first = static_cast<int>(shell.vertices.size());
  const Mesh inner = shapes::icosphere(3, 0.55);
  shell.vertices.insert(shell.vertices.end(), inner.vertices.begin(), inner.vertices.end());
  for (const Triangle& t : inner.triangles)
    shell.triangles.push_back({first + t[0], first + t[2], first + t[1]});
  const Hexahedralization hexes = hexahedralize(shell, across(10, 1));
  EXPECT_TRUE(hexes.after.proven());
  EXPECT_NEAR(enclosedVolume(hexes.mesh), signedVolume(shell), 0.05 * signedVolume(shell));
}

}  // namespace
}  // namespace innermap
