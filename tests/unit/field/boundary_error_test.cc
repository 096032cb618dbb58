#include <gtest/gtest.h>

#include <cmath>

#include "core/pi.h"
#include "core/random.h"
#include "field/sphere_problem.h"
#include "innermap/core/error.h"
#include "innermap/field/fit.h"

namespace innermap {
namespace {

TEST(BoundaryError, CountsLengthsInUnits) {
  const HarmonicField f = testing::someField();
  const Points points = testing::spherePoints(1000, 1);
  Matrix values = f.evaluate(points).values;
  // Off by (3, 4, 0) at two points of a hundred, by nothing elsewhere.
  for (std::size_t i = 0; i < 1000; i += 50) {
    values(i, 0) += 3;
    values(i, 1) += 4;
  }
  const BoundaryError e = measureBoundaryError(f, points, values, 10);
  EXPECT_NEAR(e.max, 0.5, 1e-12);
  EXPECT_NEAR(e.p99, 0.5, 1e-12);
  EXPECT_NEAR(e.rms, 0.5 * std::sqrt(0.02), 1e-12);
  EXPECT_NEAR(e.sumOfSquares, 20 * 0.25, 1e-10);
  EXPECT_EQ(e.samples, 1000u);
}

TEST(BoundaryError, LengthsByFastSumsAreAsAsked) {
  const HarmonicField f = testing::someField();
  const Points points = testing::spherePoints(500, 1);
  const Matrix values(500, 3);
  const std::vector<double> exact = boundaryErrors(f, points, values, 2),
                            fast = boundaryErrors(f, points, values, 2, {1e-6});
  const Matrix got = f.evaluate(points).values;
  for (std::size_t i = 0; i < 500; ++i) {
    const double length = std::hypot(got(i, 0), got(i, 1), got(i, 2)) / 2;
    EXPECT_NEAR(exact[i], length, 1e-12);
    EXPECT_NEAR(fast[i], length, 1e-5);
  }
  const BoundaryError e = summarizeErrors({1, 2, 2});
  EXPECT_EQ(e.max, 2);
  EXPECT_DOUBLE_EQ(e.rms, std::sqrt(3.0));
  EXPECT_EQ(summarizeErrors({}).samples, 0u);
  EXPECT_TRUE(std::isinf(e.p99Bound) && std::isinf(e.bound));  // of three no more is known
}

// Peaks of second order and pointed ones, at random points of a square: the bounds fail as often as
// they say, at most, with some luck allowed for.
TEST(BoundaryError, BoundsHoldWithTheirConfidence) {
  constexpr int kTimes = 400;
  for (const double power : {1.0, 2.0}) {
    int quantile = 0, largest = 0;
    for (int t = 0; t < kTimes; ++t) {
      const CounterRandom random(17, static_cast<std::uint64_t>(t));
      std::vector<double> lengths;
      for (std::size_t i = 0; i < 2000; ++i) {
        const double r = std::hypot(random.uniform(2 * i) - 0.5, random.uniform(2 * i + 1) - 0.5);
        lengths.push_back(1 - std::pow(r, power));
      }
      const BoundaryError e = summarizeErrors(std::move(lengths));
      quantile += e.p99Bound < 1 - std::pow(std::sqrt(0.01 / kPi), power);
      largest += e.bound < 1;
    }
    EXPECT_LT(quantile, 0.08 * kTimes);
    EXPECT_LT(largest, 0.08 * kTimes);
    EXPECT_GT(quantile, 0.01 * kTimes) << "more is allowed for than there is need to";
  }
}

TEST(BoundaryError, RefusesBadInput) {
  const HarmonicField f = testing::someField();
  EXPECT_THROW(measureBoundaryError(f, Points(2), Matrix(3, 3), 1), DataError);
  EXPECT_THROW(measureBoundaryError(f, Points(2), Matrix(2, 3), 0), SettingError);
}

}  // namespace
}  // namespace innermap
