#include "core/point_grid.h"

#include <gtest/gtest.h>

#include "core/random.h"
#include "innermap/core/error.h"

namespace innermap {
namespace {

Points randomPoints(std::size_t count, std::uint64_t seed, const Vec3& shift) {
  const CounterRandom random(seed, 7);
  Points points(count);
  for (std::size_t i = 0; i < count; ++i)
    for (int a = 0; a < 3; ++a) points[i][a] = 2 * random.uniform(3 * i + a) - 1 + shift[a];
  return points;
}

TEST(PointGrid, FindsWhatAScanFinds) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const CounterRandom random(seed, 3);
    const Vec3 shift = seed % 2 ? Vec3{1e5, -3e4, 7} : Vec3{};
    const double cell = std::pow(10, -4 + 5 * random.uniform(0));
    const Points points = randomPoints(1 + 600 * (seed % 3), seed, shift);
    const PointGrid grid(points, cell);
    ASSERT_EQ(grid.size(), points.size());
    const Points queries = randomPoints(60, seed + 100, shift);
    for (std::size_t q = 0; q + 1 < queries.size(); ++q) {
      const double radius = 0.6 * random.uniform(1 + q);
      Box3 box;
      box.add(queries[q]);
      box.add(queries[q + 1]);
      std::vector<std::size_t> inside;
      bool near = false;
      for (std::size_t i = 0; i < points.size(); ++i) {
        const Vec3& p = points[i];
        bool in = true;
        for (int a = 0; a < 3; ++a)
          in = in && p[a] >= box.lower[a] - radius && p[a] <= box.upper[a] + radius;
        if (in) inside.push_back(i);
        near = near || squaredNorm(p - queries[q]) < radius * radius;
      }
      EXPECT_EQ(grid.within(box, radius), inside);
      EXPECT_EQ(grid.anyNearer(queries[q], radius), near);
    }
  }
}

TEST(PointGrid, EmptyAndCoincident) {
  PointGrid grid(0.1);
  Box3 box;
  box.add(Vec3{1, 2, 3});
  EXPECT_TRUE(grid.within(box, 10).empty());
  EXPECT_FALSE(grid.anyNearer({1, 2, 3}, 10));
  for (int i = 0; i < 100; ++i) grid.add({1, 2, 3});
  EXPECT_EQ(grid.within(box).size(), 100u);
  EXPECT_TRUE(grid.anyNearer({1, 2, 3}, 1e-9));
  EXPECT_FALSE(grid.anyNearer({1, 2, 3.1}, 0.05));
}

TEST(PointGrid, RefusesABadCell) {
  EXPECT_THROW(PointGrid(0.0), SettingError);
  EXPECT_THROW(PointGrid(-1.0), SettingError);
  EXPECT_THROW(PointGrid(std::nan("")), SettingError);
}

}  // namespace
}  // namespace innermap
