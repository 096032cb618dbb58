#include <gtest/gtest.h>

#include "field/affine_map.h"
#include "field/sphere_problem.h"
#include "innermap/core/error.h"
#include "innermap/field/harmonic_field.h"

namespace innermap {
namespace {

// Near the identity, with charges about the ball of radius 2.
HarmonicMap gentle(double strength, const Vec3& shift) {
  Matrix weights(30, 3);
  for (std::size_t i = 0; i < 90; ++i) weights.data()[i] = strength * std::sin(i + 1.0);
  return HarmonicMap(
      HarmonicField(testing::spherePoints(30, 3), weights, test::affineOf(test::kIdentity, shift)));
}

const HarmonicMap kFirst = gentle(0.1, {0.1, 0, 0}), kSecond = gentle(-0.2, {0, -0.1, 0.05}),
                  kThird = gentle(0.15, {});
const ComposedMap kMap({kFirst, kSecond, kThird});

TEST(ComposedMap, GoesOneStepAfterTheOther) {
  const Vec3 p{0.3, -0.2, 0.5};
  EXPECT_LT(norm(kMap(p) - kThird(kSecond(kFirst(p)))), 1e-14);
  EXPECT_EQ(kMap.sources(), 90u);
  EXPECT_LT(norm(ComposedMap(kFirst)(p) - kFirst(p)), 1e-15);
  EXPECT_THROW(ComposedMap(std::vector<HarmonicMap>{}), DataError);
}

// Central differences have an error of second order: 1e-4 apart, some 1e-8.
TEST(ComposedMap, JacobianIsTheDerivative) {
  constexpr double kStep = 1e-4;
  const Vec3 p{0.3, -0.2, 0.5};
  const Mat3 j = kMap.jacobian(p);
  for (int a = 0; a < 3; ++a) {
    Vec3 step;
    step[a] = kStep;
    const Vec3 slope = (kMap(p + step) - kMap(p - step)) / (2 * kStep);
    for (int r = 0; r < 3; ++r) EXPECT_NEAR(j[r][a], slope[r], 1e-7);
  }
}

TEST(ComposedMap, ManyPointsAgreeWithSingleOnes) {
  const Points points = testing::randomPoints(500, 3);
  EvaluateFieldSettings settings{.gradients = true};
  for (const double accuracy : {0.0, 1e-9}) {
    settings.accuracy = accuracy;
    const FieldSamples s = kMap.evaluate(points, settings);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vec3 q = kMap(points[i]);
      const Mat3 j = kMap.jacobian(points[i]);
      for (int r = 0; r < 3; ++r) {
        ASSERT_NEAR(s.values(i, r), q[r], 1e-7);
        for (int a = 0; a < 3; ++a) ASSERT_NEAR(s.gradients(i, 3 * r + a), j[r][a], 1e-6);
      }
    }
  }
}

}  // namespace
}  // namespace innermap
