#include "solve/detail/clusters.h"

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

TEST(Clusters, WideOnesComeApartAtTheGap) {
  Points points = testing::randomPoints(60, 5);
  for (std::size_t i = 0; i < 20; ++i) points[i].y += 100;
  const auto clusters = clusterPoints(points, 150, 10);
  ASSERT_EQ(clusters.size(), 2u);
  EXPECT_EQ(clusters[0].size() == 20 ? clusters[0].back() : clusters[1].back(), 19u);
  std::size_t all = 0;
  for (const auto& cluster : clusterPoints(points, 150, 0.5)) {
    Box3 box;
    for (const std::size_t i : cluster) box.add(points[i]);
    const Vec3 side = box.extent();
    EXPECT_LE(std::max({side.x, side.y, side.z}), 0.5);
    all += cluster.size();
  }
  EXPECT_EQ(all, 60u);
}

}  // namespace
}  // namespace innermap
