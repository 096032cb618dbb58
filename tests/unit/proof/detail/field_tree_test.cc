#include "proof/detail/field_tree.h"

#include <gtest/gtest.h>

#include "proof/expansions.h"
#include "proof/maps.h"

namespace innermap::proof {
namespace {

using testing::Charge;
using testing::largestDifference;
using testing::ValueAndGradient;

// Of an expansion and of its near charges, at a point.
ValueAndGradient evaluateAll(const FieldTree& tree, const StepExpansion& from, const Vec3& p) {
  LaneSets sets{};
  for (std::size_t lane = 0; lane < kLanes; ++lane)
    for (int a = 0; a < 3; ++a) sets.center[a][lane] = p[a];
  alignas(64) double coefficients[kCoefficients * kLanes];
  LaneRemainders remainders{};
  moveExpansion(from, kOrder, sets, coefficients);
  OrderedCharges near{from.near, {}};
  near.ends.fill(from.near.size());
  addCharges(tree.charges(), near, sets, coefficients, remainders);
  return testing::inLane(coefficients, sets, 3);
}

// The errors at a ball's centre, over what is allowed of each.
double checkBall(const HarmonicMap& map, const FieldTree& tree, const Vec3& p, double radius) {
  const StepExpansion& from = tree.about(p, radius);
  const ValueAndGradient got = evaluateAll(tree, from, p);
  const double value = norm(got.value - map(p));
  const double gradient = largestDifference(got.gradient, map.jacobian(p));
  const Remainder& r = from.remainder;
  EXPECT_LE(value, r.value + 1e-12 * (r.valueMagnitude + 1));
  EXPECT_LE(gradient, r.gradient + 1e-12 * (r.gradientMagnitude + 1));
  return gradient / (r.gradient + 1e-12 * r.gradientMagnitude + 1e-300);
}

TEST(FieldTree, ExpansionsHoldInTheirBalls) {
  const HarmonicMap map = testing::mapOf(testing::affineOf(testing::kIdentity, {1, 2, 3}),
                                         testing::chargesAbout(3000, 1.1, 0.02, 1));
  const FieldTree tree(map.field(), 1);
  const CounterRandom random(4, 51);
  double most = 0;
  for (std::uint64_t i = 0; i < 500; ++i) {
    const Vec3 p{random.uniform(4 * i) - 0.5, random.uniform(4 * i + 1) - 0.5,
                 random.uniform(4 * i + 2) - 0.5};
    most = std::max(most,
                    checkBall(map, tree, 1.3 * p, std::pow(10.0, -4 * random.uniform(4 * i + 3))));
  }
  EXPECT_GT(most, 1e-4);
}

// All but one charge have no weight: what is cut off is that one's, from a ball far up.
TEST(FieldTree, WhatIsCutOffAboveHoldsBelow) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    std::vector<Charge> charges = {{{1, 0.7, -0.4}, {0.3, 0.2, -0.1}}};
    const CounterRandom random(seed, 52);
    for (std::uint64_t i = 0; i < 1000; ++i)
      charges.push_back(
          {{-1 + 0.01 * random.uniform(3 * i), -0.6 + 0.01 * random.uniform(3 * i + 1),
            0.5 + 0.01 * random.uniform(3 * i + 2)},
           {}});
    const HarmonicMap map = testing::mapOf(testing::affineOf(testing::kIdentity), charges);
    const FieldTree tree(map.field(), 1);
    const Vec3 p = charges[500].place + Vec3{1e-4, 0, 0};
    ASSERT_LT(tree.about(p, 1e-6).near.size(), 400u);
    EXPECT_GT(checkBall(map, tree, p, 1e-6), 1e-4);
  }
}

TEST(FieldTree, WithoutChargesIsTheAffinePart) {
  const HarmonicMap map =
      testing::mapOf(testing::affineOf({{{1, 2, 3}, {0, 1, 0}, {2, 0, 1}}}), {});
  const FieldTree tree(map.field(), 1);
  checkBall(map, tree, {0.3, 0.2, 5}, 100);
}

}  // namespace
}  // namespace innermap::proof
