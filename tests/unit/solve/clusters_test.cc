#include "innermap/solve/clusters.h"

#include <gtest/gtest.h>

#include "solve/points.h"

namespace innermap {
namespace {

TEST(Clusters, HoldEveryPointOnce) {
  for (const std::size_t count : {0, 1, 5, 150, 151, 1000}) {
    std::vector<int> seen(count, 0);
    for (const auto& cluster : clusterPoints(testing::randomPoints(count, 3), 150)) {
      EXPECT_LE(cluster.size(), 150u);
      EXPECT_FALSE(cluster.empty());
      for (const std::size_t i : cluster) ++seen[i];
    }
    for (const int s : seen) EXPECT_EQ(s, 1);
  }
}

TEST(Clusters, CoincidentPointsAreSplitToo) {
  for (const auto& cluster : clusterPoints(Points(100, Vec3{1, 2, 3}), 7))
    EXPECT_LE(cluster.size(), 7u);
}

TEST(Clusters, PointsWithinAWidenedBox) {
  const Points points = testing::randomPoints(500, 4);
  Box3 box;
  box.add(Vec3{-0.2, -0.2, -0.2});
  box.add(Vec3{0.2, 0.2, 0.2});
  const auto inside = pointsWithin(points, box, 0.1);
  std::size_t next = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3& p = points[i];
    const bool in = std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) <= 0.3;
    if (in) {
      ASSERT_LT(next, inside.size());
      EXPECT_EQ(inside[next++], i);
    }
  }
  EXPECT_EQ(next, inside.size());
}

}  // namespace
}  // namespace innermap
