#include "tetra/detail/block_topology.h"

#include <gtest/gtest.h>

#include "core/random.h"
#include "tetra/test_blocks.h"

namespace innermap {
namespace {

TEST(BlockTopology, CountsHandlesAndCavities) {
  EXPECT_EQ(topologyOf(ringOfBlocks()).handles, std::vector<int>{1});
  BlockSet hollow = emptyBlocks(5);
  for (int z = 1; z <= 3; ++z)
    for (int y = 1; y <= 3; ++y)
      for (int x = 1; x <= 3; ++x)
        hollow.filled[hollow.index({x, y, z})] = x != 2 || y != 2 || z != 2;
  EXPECT_EQ(topologyOf(hollow).handles, (std::vector<int>{0, 0}));
  EXPECT_EQ(topologyOf(hollow).cavities(), 1);
  BlockSet two = emptyBlocks(5);
  two.filled[two.index({1, 1, 1})] = two.filled[two.index({3, 1, 1})] = 1;
  EXPECT_EQ(topologyOf(two).bodies, 2);
}

TEST(BlockTopology, FindsPinchesAtEdgesAndCorners) {
  for (const Block other : {Block{2, 2, 1}, Block{2, 2, 2}}) {
    BlockSet blocks = emptyBlocks(4);
    blocks.filled[blocks.index({1, 1, 1})] = blocks.filled[blocks.index(other)] = 1;
    EXPECT_FALSE(isManifold(blocks));
    EXPECT_FALSE(manifoldAt(blocks, {2, 2, 2}));
  }
  EXPECT_TRUE(isManifold(ringOfBlocks()));
}

// A block is simple exactly if turning it leaves a manifold set of the same topology: each other
// way of meeting its neighbours changes the Euler characteristic.
TEST(BlockTopology, SimpleBlocksKeepTheTopology) {
  const CounterRandom random(1, 2);
  BlockSet blocks = ringOfBlocks();
  int simple = 0, other = 0;
  for (int i = 0; i < 4000; ++i) {
    const auto pick = [&](int k) { return 1 + static_cast<int>(random.bits(3 * i + k) % 3); };
    const Block b{pick(0), pick(1), pick(2)};
    const BlockTopology before = topologyOf(blocks);
    BlockSet turned = blocks;
    turned.filled[turned.index(b)] ^= 1;
    const bool kept = isManifold(turned) && topologyOf(turned).bodies == before.bodies &&
                      topologyOf(turned).handles == before.handles;
    ASSERT_EQ(isSimple(blocks, b), kept) << i;
    (kept ? simple : other)++;
    // Walks through sets of other topology too.
    if (kept || (isManifold(turned) && topologyOf(turned).bodies == 1 && i % 7 == 0))
      blocks = turned;
  }
  EXPECT_GT(simple, 500);
  EXPECT_GT(other, 500);
}

}  // namespace
}  // namespace innermap
