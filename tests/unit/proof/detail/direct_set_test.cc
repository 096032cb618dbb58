#include "proof/detail/direct_set.h"

#include <gtest/gtest.h>

#include "core/random.h"
#include "proof/detail/direct_jet.h"
#include "proof/maps.h"

namespace innermap::proof {
namespace {

using innermap::testing::affineOf;
using innermap::testing::Charge;
using innermap::testing::kIdentity;
using innermap::testing::longDeterminant;
using innermap::testing::longJacobian;
using innermap::testing::mapOf;

// Charges about a ball of radius 1; two of them in one place whose weights cancel.
HarmonicMap mapOfSeed(std::uint64_t seed, double cancelling = 0) {
  std::vector<Charge> charges = innermap::testing::chargesAbout(100, 1.4, 0.01, seed);
  charges.push_back({{1.3, 0, 0}, {cancelling, -cancelling, 0}});
  charges.push_back({{1.3, 0, 0}, {-cancelling, cancelling, 0}});
  return mapOf(affineOf({{{1, 0.2, 0}, {-0.1, 0.9, 0.3}, {0, 0, 1.1}}}, {0.3, -2, 1}), charges);
}

std::array<long double, 3> longValue(const HarmonicMap& map, const Vec3& p) {
  const HarmonicField& f = map.field();
  std::array<long double, 3> out{};
  for (std::size_t k = 0; k < 3; ++k) {
    out[k] = f.affine().coefficients(0, k);
    for (int a = 0; a < 3; ++a)
      out[k] +=
          static_cast<long double>(f.affine().coefficients(1 + static_cast<std::size_t>(a), k)) *
          (static_cast<long double>(p[a]) - f.affine().center[a]);
    for (std::size_t j = 0; j < f.sources().size(); ++j) {
      long double square = 0;
      for (int a = 0; a < 3; ++a) {
        const long double d = static_cast<long double>(p[a]) - f.sources()[j][a];
        square += d * d;
      }
      out[k] += f.weights()(j, k) / std::sqrt(square);
    }
  }
  return out;
}

Vec3 pointOf(const CounterRandom& random, std::uint64_t i) {
  return {2 * random.uniform(3 * i) - 1, 2 * random.uniform(3 * i + 1) - 1,
          2 * random.uniform(3 * i + 2) - 1};
}

TEST(DirectJet, KnowsItsRounding) {
  for (const double cancelling : {0.0, 1e6, 1e12})
    for (std::uint64_t seed = 1; seed < 20; ++seed) {
      SCOPED_TRACE(seed);
      const HarmonicMap map = mapOfSeed(seed, cancelling);
      const Vec3 c = 0.5 * pointOf(CounterRandom(seed, 5), 0);
      const DirectJet jet = directJet(map.field(), c, 0);
      ASSERT_TRUE(jet.known);
      const auto value = longValue(map, c);
      const auto jacobian = longJacobian(map, c);
      for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_LE(std::abs(jet.value[k] - value[k]), jet.valueError[k]);
        for (std::size_t a = 0; a < 3; ++a)
          EXPECT_LE(std::abs(jet.gradient[k][a] - jacobian[k][a]), jet.gradientError[k]);
        EXPECT_LT(jet.valueError[k], 1e-12 * (1 + 10 * cancelling));
      }
    }
}

// One charge on the way of the ball's farthest point: the bounds are nearly reached.
TEST(DirectJet, WhatIsLeftOutIsBounded) {
  for (const double radius : {0.05, 0.2, 0.5}) {
    const HarmonicMap one = mapOf(affineOf(kIdentity), {{{1, 0, 0}, {1, 0, 0}}});
    const DirectJet jet = directJet(one.field(), {}, radius);
    ASSERT_TRUE(jet.known);
    const double t = radius;
    // 1 / (1 - t) and its derivative, less their series.
    const double value = 1 / (1 - t) - 1 - t - t * t;
    const double slope = 1 / ((1 - t) * (1 - t)) - 1 - 2 * t;
    EXPECT_LE(value, jet.valueRest[0]);
    EXPECT_LE(slope, jet.gradientRest[0]);
    EXPECT_GT(value, std::pow(1 - t, 3.1) * jet.valueRest[0]);
    EXPECT_GT(slope, std::pow(1 - t, 3.1) * jet.gradientRest[0]);
  }
}

TEST(DirectJet, AChargeInTheBallLeavesNothingKnown) {
  const HarmonicMap map = mapOf(affineOf(kIdentity), {{{1, 0, 0}, {0, 0, 0}}});
  EXPECT_TRUE(directJet(map.field(), {}, 0.999).known);
  EXPECT_FALSE(directJet(map.field(), {}, 1).known);
  EXPECT_FALSE(directJet(map.field(), {1, 0, 0}, 0).known);
}

// What the set says of the image of c + t: its linear part and how far from it that may be.
void expectInImage(const DirectSet& image, const Vec3& t, double half, const Vec3& y) {
  const Vec3 linear = (t.x / half / 2) * (image.vertex[1] + image.vertex[2]) +
                      (t.y / half / 2) * (image.vertex[1] + image.vertex[3]) +
                      (t.z / half / 2) * (image.vertex[2] + image.vertex[3]);
  EXPECT_LE(norm(y - image.center - linear), image.slack * (1 + 1e-9));
}

TEST(DirectSet, HoldsImagesAndDeterminants) {
  std::size_t decided = 0;
  for (std::uint64_t seed = 1; seed < 60; ++seed) {
    SCOPED_TRACE(seed);
    const ComposedMap map(
        {mapOfSeed(seed, seed % 3 == 0 ? 0.05 : 0),
         mapOf(affineOf(kIdentity), innermap::testing::chargesAbout(50, 5, 0.1, seed + 100))});
    const CounterRandom random(seed, 7);
    const double half = 0.02 + 0.1 * random.uniform(1000);
    const ProofCell cell{0.4 * pointOf(random, 0), half};
    DirectSet set = directSet(cell);
    std::vector<Vec3> places;
    for (std::uint64_t i = 1; i < 40; ++i)
      places.push_back(i < 9 ? half * Vec3{i & 1 ? 1. : -1., i & 2 ? 1. : -1., i & 4 ? 1. : -1.}
                             : half * pointOf(random, i));
    std::vector<Vec3> at;
    for (const Vec3& t : places) at.push_back(cell.center + t);
    for (const HarmonicMap& step : map.steps()) {
      Interval determinant;
      ASSERT_TRUE(throughStep(step.field(), set, &determinant));
      decided += determinant.positive() ? 1 : 0;
      for (std::size_t i = 0; i < at.size(); ++i) {
        const long double there = longDeterminant(step, at[i]);
        EXPECT_LE(determinant.lower, there);
        EXPECT_GE(determinant.upper, there);
        at[i] = step(at[i]);
        expectInImage(set, places[i], half, at[i]);
      }
    }
  }
  EXPECT_GT(decided, 60u);
}

}  // namespace
}  // namespace innermap::proof
