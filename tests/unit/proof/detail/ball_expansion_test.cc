#include "proof/detail/ball_expansion.h"

#include <gtest/gtest.h>

#include "proof/expansions.h"
#include "proof/maps.h"

namespace innermap::proof {
namespace {

using testing::ValueAndGradient;

StepExpansion nothing() {
  StepExpansion out;
  out.coefficients.assign(kCoefficients, 0);
  return out;
}

std::vector<double> packed(const std::vector<testing::Charge>& charges) {
  std::vector<double> out;
  for (const testing::Charge& c : charges)
    out.insert(out.end(), {c.place.x, c.place.y, c.place.z, c.weight.x, c.weight.y, c.weight.z,
                           norm(c.weight), 0});
  return out;
}

std::vector<std::uint32_t> upTo(std::size_t count) {
  std::vector<std::uint32_t> out(count);
  for (std::size_t i = 0; i < count; ++i) out[i] = static_cast<std::uint32_t>(i);
  return out;
}

// Of charges in a ball: its expansion.
StepExpansion expanded(const std::vector<testing::Charge>& charges, const ExpansionBall& ball,
                       double farRatio, OrderedCharges& far) {
  const std::vector<double> all = packed(charges);
  std::vector<std::int32_t> places;
  sortCharges(all.data(), upTo(charges.size()), ball, orderLimits(farRatio), places, far);
  StepExpansion out;
  expandAbout(all.data(), nothing(), kOrder, far, ball, out);
  return out;
}

ValueAndGradient sumOf(const std::vector<testing::Charge>& charges, const Vec3& p) {
  const HarmonicMap map = testing::mapOf(testing::affineOf(Mat3{}), charges);
  return {map(p), map.jacobian(p)};
}

// The root of the sum of the squares: of one charge the spectral norm as well.
double distance(const Mat3& a, const Mat3& b) {
  double squares = 0;
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) squares += (a[r][c] - b[r][c]) * (a[r][c] - b[r][c]);
  return std::sqrt(squares);
}

// At the point of the ball that is nearest to the charge the bounds are reached.
TEST(BallExpansion, WhatEachOrderLeavesOut) {
  const Vec3 center{0.3, -0.2, 0.1}, way = Vec3{2, -1, 2} / 3.0;
  const double radius = 0.5;
  std::array<int, kOrders.size()> used{};
  for (const double farRatio : {0.36, 0.2})
    for (double ratio = farRatio; ratio > 0.01; ratio *= 0.9) {
      const std::vector<testing::Charge> charges = {
          {center + (radius / ratio * (1 + 1e-9)) * way, {0.3, 0.1, -0.2}}};
      OrderedCharges far;
      const StepExpansion got = expanded(charges, {center, radius}, farRatio, far);
      ASSERT_EQ(far.count(), 1u);
      ++used[static_cast<std::size_t>(std::count(far.ends.begin(), far.ends.end(), 0u))];
      const Vec3 p = center + radius * way;
      const ValueAndGradient is = testing::evaluate(got, p), should = sumOf(charges, p);
      const double off = distance(is.gradient, should.gradient);
      const double weight = norm(charges[0].weight), d = radius / ratio;
      const double rounding = 1e-14 * weight / (d * d);
      EXPECT_LE(off, got.remainder.gradient + rounding);
      EXPECT_GE(off, 0.99 * got.remainder.gradient - rounding);
      EXPECT_LE(norm(is.value - should.value), got.remainder.value + rounding * d);
      EXPECT_GE(norm(is.value - should.value), 0.99 * got.remainder.value - rounding * d);
      // No more than where charges become near.
      const double most = std::pow(farRatio, kOrder) * (kOrder + 1 - kOrder * farRatio) /
                          ((1 - farRatio) * (1 - farRatio));
      EXPECT_LE(got.remainder.gradient, most * weight / (d * d) * (1 + 1e-6));
    }
  for (const int count : used) EXPECT_GT(count, 2);
}

TEST(BallExpansion, NearChargesStayOut) {
  OrderedCharges far;
  expanded({{{1, 0, 0}, {1, 1, 1}}, {{3, 0, 0}, {1, 1, 1}}, {{20, 0, 0}, {1, 1, 1}}}, {{}, 0.5},
           0.36, far);
  EXPECT_EQ(far.list, std::vector<std::uint32_t>({1, 2, 0}));
  EXPECT_EQ(far.count(), 2u);
}

// Sums of many charges, of all orders, moved to another ball.
TEST(BallExpansion, HoldsInItsBall) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    std::vector<testing::Charge> charges = testing::chargesAbout(37 + seed, 1.5, 0.1, seed);
    const std::vector<testing::Charge> more = testing::chargesAbout(50, 3, 0.1, seed + 50);
    charges.insert(charges.end(), more.begin(), more.end());
    OrderedCharges far;
    const StepExpansion outer = expanded(charges, {{}, 0.5}, 0.36, far);
    ASSERT_EQ(far.count(), charges.size());
    StepExpansion inner;
    expandAbout(nullptr, outer, kOrder, {}, {{0.1, 0.2, -0.1}, 0.25}, inner);
    const CounterRandom random(seed, 53);
    for (std::uint64_t i = 0; i < 20; ++i) {
      const Vec3 p = inner.center + 0.14 * Vec3{2 * random.uniform(3 * i) - 1,
                                                2 * random.uniform(3 * i + 1) - 1,
                                                2 * random.uniform(3 * i + 2) - 1};
      const ValueAndGradient is = testing::evaluate(inner, p), should = sumOf(charges, p);
      const Remainder& r = inner.remainder;
      EXPECT_LE(norm(is.value - should.value), r.value + 1e-12 * r.valueMagnitude);
      EXPECT_LE(testing::largestDifference(is.gradient, should.gradient),
                r.gradient + 1e-12 * r.gradientMagnitude);
    }
  }
}

TEST(BallExpansion, DegreesThatAreNotWorthMoving) {
  std::array<int, kOrder + 1> orders{};
  for (std::uint64_t seed = 0; seed < 20; ++seed)
    for (const double radius : {0.5, 0.2, 0.05, 0.01}) {
      const std::vector<testing::Charge> charges = testing::chargesAbout(60, 1.5, 0.1, seed);
      OrderedCharges far;
      const StepExpansion from = expanded(charges, {{}, 0.5}, 0.36, far);
      Remainder rest;
      const int order = worthyOrder(from, {{}, radius}, rest);
      ++orders[order];
      StepExpansion low = from;
      std::fill(low.coefficients.begin() + static_cast<std::ptrdiff_t>(6 * termOf(order + 1, 0)),
                low.coefficients.end(), 0.0);
      const CounterRandom random(seed, 54);
      for (std::uint64_t i = 0; i < 20; ++i) {
        Vec3 p{random.uniform(3 * i) - 0.5, random.uniform(3 * i + 1) - 0.5,
               random.uniform(3 * i + 2) - 0.5};
        p = radius / norm(p) * p;
        const ValueAndGradient is = testing::evaluate(low, p), should = testing::evaluate(from, p);
        EXPECT_LE(norm(is.value - should.value), rest.value + 1e-14);
        EXPECT_LE(testing::largestDifference(is.gradient, should.gradient), rest.gradient + 1e-13);
        // The lanes' move leaves out the same.
        LaneSets sets{};
        for (std::size_t lane = 0; lane < kLanes; ++lane)
          for (int a = 0; a < 3; ++a) sets.center[a][lane] = p[a];
        alignas(64) double c[kCoefficients * kLanes];
        moveExpansion(from, order, sets, c);
        LaneRemainders remainders{};
        addInherited(from, rest, sets, remainders);
        EXPECT_GE(remainders.gradient[2], from.remainder.gradient + rest.gradient);
        EXPECT_GE(remainders.value[2], from.remainder.value + rest.value);
        const ValueAndGradient moved = testing::inLane(c, sets, 5);
        EXPECT_LE(norm(moved.value - is.value), 1e-13);
        EXPECT_LE(testing::largestDifference(moved.gradient, is.gradient), 1e-12);
      }
    }
  EXPECT_GT(orders[kOrder], 0);
  EXPECT_GT(orders[3] + orders[2], 0);
}

}  // namespace
}  // namespace innermap::proof
