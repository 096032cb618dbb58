#include "core/disjoint_sets.h"

#include <gtest/gtest.h>

namespace innermap {
namespace {

TEST(DisjointSets, AreRepresentedByTheirLowest) {
  DisjointSets sets(6);
  for (int i = 0; i < 6; ++i) EXPECT_EQ(sets.find(i), i);
  EXPECT_TRUE(sets.unite(5, 3));
  EXPECT_TRUE(sets.unite(4, 5));
  EXPECT_FALSE(sets.unite(3, 4));
  EXPECT_TRUE(sets.unite(1, 4));
  EXPECT_EQ(sets.representatives(), (std::vector<int>{0, 1, 2, 1, 1, 1}));
}

TEST(DisjointSets, LongChainsInAnyOrder) {
  constexpr int kCount = 1000;
  DisjointSets up(kCount), down(kCount);
  for (int i = 2; i < kCount; ++i) up.unite(i, i - 2);
  for (int i = kCount - 1; i > 1; --i) down.unite(i - 2, i);
  for (int i = 0; i < kCount; ++i) {
    EXPECT_EQ(up.find(i), i % 2);
    EXPECT_EQ(down.find(i), i % 2);
  }
}

TEST(DisjointSets, MayBeNone) { EXPECT_TRUE(DisjointSets(0).representatives().empty()); }

}  // namespace
}  // namespace innermap
