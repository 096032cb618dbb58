#include <gtest/gtest.h>

#include "innermap/tetra/hexahedralize.h"
#include "mesh/shapes.h"
#include "tetra/detail/block_topology.h"

namespace innermap {
namespace {

PolycubeSettings blocksAcross(int blocks) { return {.blocks = blocks}; }

void append(Mesh& mesh, const Mesh& other, bool turned) {
  const int first = static_cast<int>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), other.vertices.begin(), other.vertices.end());
  for (Triangle t : other.triangles) {
    if (turned) std::swap(t[1], t[2]);
    mesh.triangles.push_back({first + t[0], first + t[1], first + t[2]});
  }
}

TEST(Polycube, BallIsNearAndSymmetric) {
  const Polycube cube = makePolycube(shapes::icosphere(4), blocksAcross(10));
  EXPECT_EQ(cube.across, 10);
  EXPECT_EQ(cube.handles, 0);
  EXPECT_LT(cube.missed, 0.08);
  EXPECT_LT(cube.surplus, 0.12);
  const Mesh surface = blockSurface(cube.blocks, 1);
  const Vec3 middle = boundingBox(surface).center();
  EXPECT_LT(norm(middle), 0.15);  // less than a block
  EXPECT_NEAR(signedVolume(surface) * (1 + cube.missed - cube.surplus), 4.189, 0.5);
}

TEST(Polycube, KeepsHandles) {
  for (const int blocks : {8, 11, 16}) {
    const Polycube cube = makePolycube(shapes::torus(60, 24), blocksAcross(blocks));
    EXPECT_EQ(cube.handles, 1);
    EXPECT_EQ(topologyOf(cube.blocks).handles, std::vector<int>{1});
    EXPECT_TRUE(isManifold(cube.blocks));
  }
}

TEST(Polycube, KeepsCavities) {
  Mesh shell = shapes::icosphere(4);
  append(shell, shapes::icosphere(3, 0.5), true);
  const Polycube cube = makePolycube(shell, blocksAcross(12));
  EXPECT_EQ(cube.cavities, 1);
  EXPECT_EQ(topologyOf(cube.blocks).handles, (std::vector<int>{0, 0}));
}

TEST(Polycube, ChoosesTheNumberOfBlocks) {
  const Polycube ball = makePolycube(shapes::icosphere(3));
  EXPECT_GT(ball.blocks.count(), 700u);
  EXPECT_LT(ball.blocks.count(), 1300u);
  const Polycube thin = makePolycube(shapes::torus(80, 16, 1, 0.15));
  EXPECT_GT(thin.across, 2 * ball.across);
}

// A needle of a hundredth of the body's width is in no block, and told.
TEST(Polycube, TellsWhatIsMissed) {
  Mesh mesh = shapes::icosphere(4);
  for (Vec3& v : mesh.vertices)
    if (v.x > 0.98) v.x += 2 * (v.x - 0.98) / 0.02;
  const Polycube cube = makePolycube(mesh, blocksAcross(9));
  ASSERT_FALSE(cube.missedParts.empty());
  EXPECT_GT(cube.missedParts[0].centre.x, 1.2);
  EXPECT_GT(cube.missed, cube.missedParts[0].volume);
}

}  // namespace
}  // namespace innermap
