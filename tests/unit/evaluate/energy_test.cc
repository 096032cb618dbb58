#include <gtest/gtest.h>

#include <string>

#include "core/pi.h"
#include "core/random.h"
#include "innermap/evaluate/evaluate_map.h"

namespace innermap {
namespace {

Mat3 rotation(double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  return {{{c, -s, 0}, {s, c, 0}, {0, 0, 1}}};
}

Mat3 product(const Mat3& a, const Mat3& b) {
  Mat3 m{};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      for (int k = 0; k < 3; ++k) m[i][j] += a[i][k] * b[k][j];
  return m;
}

TEST(Energy, RotationsCostNothing) {
  for (const double angle : {0.0, 0.3, 2.0, kPi}) {
    EXPECT_NEAR(deformationEnergyDensity(rotation(angle)), 0, 1e-30);
    EXPECT_NEAR(harmonicEnergyDensity(rotation(angle)), 3, 1e-14);
  }
}

TEST(Energy, UniformScalingHasAClosedForm) {
  const LameConstants lame{0.7, 1.3};
  for (const double s : {0.5, 1.1, 3.0}) {
    const Mat3 j{{{s, 0, 0}, {0, s, 0}, {0, 0, s}}};
    const double e = s * s - 1;
    EXPECT_NEAR(deformationEnergyDensity(j, lame), e * e * (4.5 * lame.lambda + 3 * lame.mu),
                1e-12 * s * s * s * s);
    EXPECT_NEAR(harmonicEnergyDensity(j), 3 * s * s, 1e-12);
  }
}

TEST(Energy, SimpleShearHasAClosedForm) {
  // J = I + g e_x e_y^T: J^T J - I has xy = yx = g and yy = g^2.
  const double g = 0.4;
  const Mat3 j{{{1, g, 0}, {0, 1, 0}, {0, 0, 1}}};
  const LameConstants lame{0.2, 0.9};
  EXPECT_NEAR(deformationEnergyDensity(j, lame),
              0.5 * lame.lambda * std::pow(g, 4) + lame.mu * (2 * g * g + std::pow(g, 4)), 1e-15);
}

TEST(Energy, DoesNotSeeRotationsOfTheTarget) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const CounterRandom random(seed, 0);
    Mat3 j;
    for (int i = 0; i < 9; ++i) j[i / 3][i % 3] = 2 * random.uniform(i) - 1;
    const Mat3 turned = product(rotation(6 * random.uniform(9)), j);
    EXPECT_NEAR(deformationEnergyDensity(turned), deformationEnergyDensity(j), 1e-13);
    EXPECT_NEAR(harmonicEnergyDensity(turned), harmonicEnergyDensity(j), 1e-13);
    EXPECT_GE(deformationEnergyDensity(j), 0);
  }
}

}  // namespace
}  // namespace innermap
