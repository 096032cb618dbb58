#include "core/random.h"

#include <gtest/gtest.h>

#include <cmath>

namespace innermap {
namespace {

TEST(Random, UniformMomentsAreRight) {
  const CounterRandom random(42, 0);
  const int n = 100000;
  double mean = 0, square = 0, lag = 0;
  for (int i = 0; i < n; ++i) {
    const double x = random.uniform(i);
    ASSERT_GE(x, 0);
    ASSERT_LT(x, 1);
    mean += x / n;
    square += x * x / n;
    lag += (x - 0.5) * (random.uniform(i + 1) - 0.5) / n;
  }
  // Five standard deviations of each estimate.
  EXPECT_NEAR(mean, 0.5, 5 * std::sqrt(1.0 / 12 / n));
  EXPECT_NEAR(square, 1.0 / 3, 5 * std::sqrt(4.0 / 45 / n));
  EXPECT_NEAR(lag, 0, 5 / 12.0 / std::sqrt(n));
}

TEST(Random, SeedsAndStreamsDiffer) {
  EXPECT_EQ(CounterRandom(1, 2).bits(3), CounterRandom(1, 2).bits(3));
  EXPECT_NE(CounterRandom(1, 2).bits(3), CounterRandom(1, 3).bits(3));
  EXPECT_NE(CounterRandom(1, 2).bits(3), CounterRandom(2, 2).bits(3));
}

}  // namespace
}  // namespace innermap
