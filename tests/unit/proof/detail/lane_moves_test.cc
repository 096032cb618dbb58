#include <gtest/gtest.h>

#include <cmath>
#include <complex>

#include "core/random.h"
#include "proof/expansions.h"

namespace innermap::proof {
namespace {

// By the definition of the header step_expansion.h, in place of the recurrences of the kernels.
std::complex<double> conjugateRegular(int n, int m, const Vec3& x) {
  const double r = norm(x);
  return std::pow(r, n) * std::assoc_legendre(n, m, x.z / r) / std::tgamma(n + m + 1) *
         std::polar(1.0, -m * std::atan2(x.y, x.x));
}

Vec3 valueAt(const StepExpansion& of, const Vec3& x) {
  Vec3 out;
  for (int n = 0; n <= kOrder; ++n)
    for (int m = 0; m <= n; ++m)
      for (int k = 0; k < 3; ++k) {
        const double* const c = of.coefficients.data() + 6 * termOf(n, m) + 2 * k;
        const std::complex<double> product =
            std::complex<double>(c[0], c[1]) * conjugateRegular(n, m, x - of.center);
        out[k] += (m == 0 ? 1 : 2) * product.real();
      }
  return out;
}

Vec3 randomPoint(const CounterRandom& random, std::uint64_t i) {
  return {random.uniform(3 * i) - 0.5, random.uniform(3 * i + 1) - 0.5,
          random.uniform(3 * i + 2) - 0.5};
}

// Of degree n as large as what a charge at distance 1 has.
StepExpansion randomExpansion(const CounterRandom& random) {
  StepExpansion out;
  out.center = randomPoint(random, 1000);
  out.coefficients.assign(kCoefficients, 0);
  for (int n = 0; n <= kOrder; ++n)
    for (int m = 0; m <= n; ++m)
      for (int i = 0; i < 6; ++i) {
        const std::size_t place = 6 * termOf(n, m) + static_cast<std::size_t>(i);
        if (m == 0 && i % 2) continue;
        out.coefficients[place] = (random.uniform(place) - 0.5) / std::sqrt(kSchmidt[termOf(n, m)]);
      }
  return out;
}

TEST(LaneMoves, AreExact) {
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    SCOPED_TRACE(seed);
    const CounterRandom random(seed, 55);
    const StepExpansion from = randomExpansion(random);
    StepExpansion to;
    to.center = randomPoint(random, 1001);
    to.coefficients.resize(kCoefficients);
    moveExpansion(from, kOrder, to.center, to.coefficients.data());
    for (std::uint64_t i = 1002; i < 1010; ++i) {
      const Vec3 x = randomPoint(random, i);
      EXPECT_LE(norm(valueAt(to, x) - valueAt(from, x)), 1e-10);
    }
  }
}

TEST(LaneMoves, OfEightAreThoseOfOne) {
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    SCOPED_TRACE(seed);
    const CounterRandom random(seed, 56);
    const StepExpansion from = randomExpansion(random);
    LaneSets sets{};
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const Vec3 center = randomPoint(random, 1002 + lane);
      for (int a = 0; a < 3; ++a) sets.center[a][lane] = center[a];
    }
    alignas(64) double all[kCoefficients * kLanes];
    moveExpansion(from, kOrder, sets, all);
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const Vec3 center = randomPoint(random, 1002 + lane);
      const testing::ValueAndGradient one = testing::evaluate(from, center);
      const testing::ValueAndGradient is = testing::inLane(all, sets, lane);
      EXPECT_LE(norm(is.value - one.value), 1e-11);
      EXPECT_LE(testing::largestDifference(is.gradient, one.gradient), 1e-11);
    }
  }
}

}  // namespace
}  // namespace innermap::proof
