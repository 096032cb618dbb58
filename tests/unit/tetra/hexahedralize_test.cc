#include "innermap/tetra/hexahedralize.h"

#include <gtest/gtest.h>

#include "core/memory_limit.h"
#include "innermap/core/error.h"
#include "innermap/core/run.h"
#include "mesh/shapes.h"

namespace innermap {
namespace {

double volumeOf(const CellMesh& mesh) {
  return signedVolume(mesh.vertices, boundaryTriangles(mesh));
}

HexahedralizeSettings across(int blocks, int pieces) {
  HexahedralizeSettings settings;
  settings.polycube.blocks = blocks;
  settings.pieces = pieces;
  return settings;
}

TEST(HexahedralizeRelease, FillsATorus) {
  const Mesh torus = shapes::torus(60, 24);
  const Hexahedralization hexes = hexahedralize(torus, across(11, 1));
  EXPECT_GT(hexes.before.inverted, 0u);
  EXPECT_TRUE(hexes.after.proven());
  EXPECT_EQ(hexes.quality.invertedHexahedra, 0u);
  EXPECT_GT(hexes.quality.jacobian.least, 0.2);
  EXPECT_GT(hexes.quality.jacobian.mean, 0.75);
  // Hexahedra are some 0.05 of the diagonal wide; flat faces cut a circle of half that radius short
  // by a twentieth of their width.
  EXPECT_LT(hexes.boundary.fromSurface.rms, 5e-3);
  EXPECT_LT(hexes.boundary.fromSurface.max, 2e-2);
  EXPECT_NEAR(volumeOf(hexes.mesh), signedVolume(torus), 0.05 * signedVolume(torus));
  EXPECT_NEAR(volumeOf(hexes.inBlocks), signedVolume(blockSurface(hexes.polycube.blocks, 1)), 1e-9);
  EXPECT_EQ(hexes.inBlocks.hexahedra, hexes.mesh.hexahedra);
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
  EXPECT_NEAR(volumeOf(hexes.mesh), signedVolume(shell), 0.05 * signedVolume(shell));
}

TEST(HexahedralizeRelease, SameForAnyNumberOfThreads) {
  const Mesh ball = shapes::icosphere(2);
  Points first;
  for (const int threads : {1, 2}) {
    const ThreadLimit limit(threads);
    const Hexahedralization hexes = hexahedralize(ball, across(4, 1));
    if (first.empty()) {
      first = hexes.mesh.vertices;
      continue;
    }
    ASSERT_EQ(first.size(), hexes.mesh.vertices.size());
    double difference = 0;
    for (std::size_t v = 0; v < first.size(); ++v)
      difference = std::max(difference, norm(first[v] - hexes.mesh.vertices[v]));
    EXPECT_LT(difference, 1e-15);
  }
}

TEST(Hexahedralize, RefusesSettingsOutOfRangeAndStops) {
  const Mesh ball = shapes::icosphere(2);
  EXPECT_THROW(hexahedralize(ball, across(4, 0)), SettingError);
  EXPECT_THROW(hexahedralize(ball, across(4, 17)), SettingError);
  HexahedralizeSettings settings = across(4, 1);
  {
    const MemoryLimit limit(1000);
    EXPECT_THROW(hexahedralize(ball, settings), MemoryError);
  }
  RunContext run;
  run.cancel();
  const RunScope scope(run);
  EXPECT_THROW(hexahedralize(ball, settings), Cancelled);
}

}  // namespace
}  // namespace innermap
