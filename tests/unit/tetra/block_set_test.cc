#include <gtest/gtest.h>

#include <set>

#include "innermap/core/error.h"
#include "innermap/mesh/check.h"
#include "innermap/tetra/hexahedralize.h"
#include "tetra/test_blocks.h"

namespace innermap {
namespace {

TEST(BlockSet, SurfaceIsClosedAndOfTheBlocksVolume) {
  const BlockSet blocks = ringOfBlocks();
  for (const int pieces : {1, 3}) {
    const Mesh surface = blockSurface(blocks, pieces);
    const MeshReport report = checkMesh(surface);
    EXPECT_TRUE(report.closed);
    EXPECT_TRUE(report.nonManifoldVertices.empty());
    EXPECT_EQ(report.genus, 1);
    EXPECT_EQ(surface.triangles.size(), 2u * 32 * pieces * pieces);
    EXPECT_NEAR(signedVolume(surface), 8 * 0.125, 1e-12);
  }
}

TEST(BlockSet, UsualPiecesGiveAMeshThatCanBeMapped) {
  const BlockSet blocks = ringOfBlocks();
  const int pieces = usualPieces(blocks);
  EXPECT_GE(blockSurface(blocks, pieces).vertices.size(), 3000u);
  EXPECT_LT(blockSurface(blocks, pieces - 1).vertices.size(), 3000u);
}

TEST(BlockSet, HexahedraFillTheBlocks) {
  const BlockSet blocks = ringOfBlocks();
  const BlockHexahedra hexes = blockHexahedra(blocks, 2);
  EXPECT_EQ(hexes.core, 8u * 8);
  EXPECT_EQ(hexes.mesh.hexahedra.size(), 8u * 8 + 32 * 4);
  EXPECT_NO_THROW(validate(hexes.mesh));
  const std::vector<Triangle> boundary = boundaryTriangles(hexes.mesh);
  EXPECT_NEAR(signedVolume(hexes.mesh.vertices, boundary), 8 * 0.125, 1e-12);
  // The boundary's vertices are the outer ones of the skin, each once.
  std::set<int> used, outer;
  for (const Triangle& t : boundary) used.insert(t.begin(), t.end());
  for (const auto& skin : hexes.skin) EXPECT_TRUE(outer.insert(skin.outer).second);
  EXPECT_EQ(used, outer);
}

TEST(BlockSet, LayerOfOneBlockIsRightSideOut) {
  BlockSet blocks = emptyBlocks(3);
  blocks.filled[blocks.index({1, 1, 1})] = 1;
  const BlockHexahedra hexes = blockHexahedra(blocks, 3, 0.5);
  for (const Hexahedron& h : hexes.mesh.hexahedra)
    for (const Tetrahedron& t : cornerTetrahedra(h))
      EXPECT_GT(signedVolume(hexes.mesh.vertices, t), 0);
}

TEST(BlockSet, RefusesSettingsOutOfRange) {
  const BlockSet blocks = ringOfBlocks();
  EXPECT_THROW(blockSurface(blocks, 0), SettingError);
  EXPECT_THROW(blockHexahedra(blocks, 1001), SettingError);
  EXPECT_THROW(blockHexahedra(blocks, 2, 1), SettingError);
}

}  // namespace
}  // namespace innermap
