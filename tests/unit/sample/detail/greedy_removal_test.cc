#include "sample/detail/greedy_removal.h"

#include <gtest/gtest.h>

#include <cstdint>

#include "core/random.h"
#include "innermap/core/run.h"

namespace innermap {
namespace {

// The loop as Yuksel states it, one point at a time, with weights in the same whole numbers.
std::vector<std::size_t> oneByOne(const NeighbourGrid& grid, std::size_t count,
                                  const NeighbourWeight& weight) {
  const auto given = [&](double squared) {
    return static_cast<std::int64_t>(0x1p40 * weight(squared));
  };
  std::vector<std::int64_t> weights(grid.size(), 0);
  for (std::size_t i = 0; i < grid.size(); ++i)
    grid.forNeighbours(i, [&](std::size_t, double squared) { weights[i] += given(squared); });
  for (std::size_t left = grid.size(); left > count; --left) {
    const auto heaviest = std::max_element(weights.begin(), weights.end());
    *heaviest = -1;
    grid.forNeighbours(static_cast<std::size_t>(heaviest - weights.begin()),
                       [&](std::size_t j, double squared) {
                         if (weights[j] >= 0) weights[j] -= given(squared);
                       });
  }
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < weights.size(); ++i)
    if (weights[i] >= 0) kept.push_back(i);
  return kept;
}

// On a sheet and in a clump, some at the same place; the grid has some ten cubes of cells.
Points scattered(std::uint64_t seed) {
  const CounterRandom random(seed, 1);
  Points points;
  for (std::uint64_t i = 0; i < 3000; ++i) {
    const double x = random.uniform(3 * i), y = random.uniform(3 * i + 1);
    const double z = random.uniform(3 * i + 2);
    if (i % 50 == 1)
      points.push_back(points.back());
    else if (i % 5 == 0)
      points.push_back({0.5 + 0.05 * x, 0.5 + 0.05 * y, 0.05 * z});
    else
      points.push_back({x, y, 0.1 * x * y});
  }
  return points;
}

TEST(GreedyRemovalRelease, IsTheLoopOneByOneForAnyNumberOfThreads) {
  for (const std::uint64_t seed : {1u, 2u}) {
    const double radius = 0.03;
    const NeighbourGrid grid(scattered(seed), radius);
    const NeighbourWeight weight{radius, 0.3 * radius};
    EXPECT_GT(grid.cubes(4).size(), 5u);
    for (const std::size_t count : {0u, 1u, 700u, 2000u, 2999u, 3000u}) {
      SCOPED_TRACE(::testing::Message() << "seed " << seed << ", " << count << " left");
      const std::vector<std::size_t> expected = oneByOne(grid, count, weight);
      for (const int threads : {1, 4}) {
        const ThreadLimit limit(threads);
        EXPECT_EQ(heaviestRemoved(grid, count, weight), expected);
      }
    }
  }
}

TEST(NeighbourGrid, CubesHoldEveryCellOnceAndNeighboursAreThoseWithin) {
  const Points points = scattered(4);
  const double radius = 0.03;
  const NeighbourGrid grid(points, radius);
  std::vector<int> times(grid.cellStarts().size() - 1, 0);
  for (const auto& cube : grid.cubes(3))
    for (const std::uint32_t cell : cube) ++times[cell];
  for (const int t : times) EXPECT_EQ(t, 1);
  for (std::size_t i = 0; i < grid.size(); i += 100) {
    std::size_t found = 0, expected = 0;
    grid.forNeighbours(i, [&](std::size_t, double) { ++found; });
    for (std::size_t j = 0; j < grid.size(); ++j)
      expected += j != i && squaredNorm(grid.point(j) - grid.point(i)) < radius * radius;
    EXPECT_EQ(found, expected);
  }
}

}  // namespace
}  // namespace innermap
