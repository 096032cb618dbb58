#include "innermap/solve/kernel_sum.h"

#include <gtest/gtest.h>

#include "core/expect.h"
#include "innermap/core/error.h"
#include "innermap/core/run.h"
#include "solve/points.h"

namespace innermap {
namespace {

// Sum of the absolute terms: what relative rounding errors are relative to.
void expectSums(const Points& points, const Points& sources, const Matrix& w) {
  const FieldSamples got = sumCharges(Charges(sources, w), points, true);
  const double tolerance = 64 * std::numeric_limits<double>::epsilon();
  for (std::size_t k = 0; k < w.columns(); ++k)
    for (std::size_t i = 0; i < points.size(); ++i) {
      double value = 0, size = 0, slopeSize = 0;
      Vec3 slope;
      for (std::size_t j = 0; j < sources.size(); ++j) {
        const Vec3 d = points[i] - sources[j];
        const double r = norm(d);
        if (!(r > 0)) continue;
        value += w(j, k) / r;
        size += std::abs(w(j, k)) / r;
        slope += (-w(j, k) / (r * r * r)) * d;
        slopeSize += std::abs(w(j, k)) / (r * r);
      }
      const double n = static_cast<double>(sources.size()) + 1;
      ASSERT_NEAR(got.values(i, k), value, tolerance * n * size) << "point " << i;
      for (int a = 0; a < 3; ++a)
        ASSERT_NEAR(got.gradients(i, 3 * k + a), slope[a], tolerance * n * slopeSize);
    }
}

TEST(KernelSum, EqualsThePlainLoop) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const std::size_t channels = seed, points = 1 + 97 * (seed - 1), sources = 1 + 61 * (seed - 1);
    expectSums(testing::randomPoints(points, seed), testing::randomPoints(sources, seed + 100),
               testing::randomWeights(sources, channels, seed));
  }
}

TEST(KernelSum, CoincidentSourceContributesNothing) {
  const Points points = testing::randomPoints(40, 5);
  expectSums(points, points, testing::randomWeights(40, 3, 5));
}

TEST(KernelSum, NoSourcesGiveZero) {
  const FieldSamples got =
      sumCharges(Charges({}, Matrix(0, 3)), testing::randomPoints(10, 1), true);
  for (std::size_t i = 0; i < 30; ++i) EXPECT_EQ(got.values.data()[i], 0);
}

TEST(KernelSum, KeepsDigitsAtAnyScale) {
  for (const double scale : {1e-12, 1e-3, 1e3, 1e12}) {
    Points points = testing::randomPoints(100, 2), sources = testing::randomPoints(50, 3);
    for (Vec3& p : points) p = scale * p;
    for (Vec3& p : sources) p = scale * p;
    expectSums(points, sources, testing::randomWeights(50, 3, 4));
  }
}

TEST(KernelSum, SameBitsForAnyNumberOfThreads) {
  const Points points = testing::randomPoints(3000, 11), sources = testing::randomPoints(500, 12);
  const Charges charges(sources, testing::randomWeights(500, 3, 13));
  const FieldSamples all = sumCharges(charges, points, true);
  const ThreadLimit one(1);
  const FieldSamples single = sumCharges(charges, points, true);
  EXPECT_TRUE(std::equal(all.values.data(), all.values.data() + 9000, single.values.data()));
  EXPECT_TRUE(
      std::equal(all.gradients.data(), all.gradients.data() + 27000, single.gradients.data()));
}

TEST(KernelSum, MatrixTimesWeightsIsTheSum) {
  const Points points = testing::randomPoints(130, 21), sources = testing::randomPoints(70, 22);
  const Matrix w = testing::randomWeights(70, 1, 23);
  Matrix a(130, 70);
  fillKernelMatrix(points, sources, 2, a.data(), 130);
  const Matrix sums = sumCharges(Charges(sources, w), points, false).values;
  for (std::size_t i = 0; i < 130; ++i) {
    double value = 0;
    for (std::size_t j = 0; j < 70; ++j) value += a(i, j) * w(j, 0);
    EXPECT_NEAR(value, 2 * sums(i, 0), 1e-11);
  }
}

TEST(KernelSum, RefusesWrongSizesAndNan) {
  EXPECT_THROW(Charges(Points(3), Matrix(2, 1)), DataError);
  Matrix w(1, 1);
  w(0, 0) = std::nan("");
  EXPECT_THROW(Charges(Points(1), w), DataError);
}

TEST(KernelSum, CancelStopsIt) {
  test::expectCancels([&] { sumCharges(Charges(Points(1), Matrix(1, 1)), Points(10), false); });
}

}  // namespace
}  // namespace innermap
