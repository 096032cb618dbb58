#include "innermap/tetra/detail/sharp_edges.h"

#include <gtest/gtest.h>

#include "innermap/core/detail/pi.h"
#include "mesh/shapes.h"
#include "tetra/test_blocks.h"

namespace innermap {
namespace {

TEST(SharpEdges, AreThoseOfACube) {
  BlockSet blocks = emptyBlocks(3);
  blocks.filled[blocks.index({1, 1, 1})] = 1;
  const Mesh cube = blockSurface(blocks, 2);
  const SharpEdges sharp = sharpEdges(cube, kPi / 6);
  EXPECT_EQ(sharp.edges.size(), 24u);
  EXPECT_NEAR(sharp.length, 12 * 0.5, 1e-12);
  EXPECT_EQ(samplesOf(cube, sharp, 240).size(), 240u);
  EXPECT_TRUE(sharpEdges(cube, 0.51 * kPi).edges.empty());
  EXPECT_TRUE(samplesOf(cube, {}, 100).empty());
}

TEST(SharpEdges, AreNotOnABall) {
  EXPECT_TRUE(sharpEdges(shapes::icosphere(3), kPi / 6).edges.empty());
}

}  // namespace
}  // namespace innermap
