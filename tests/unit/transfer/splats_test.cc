#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/pi.h"
#include "innermap/transfer/geometry.h"
#include "transfer/detail/colour_harmonics.h"
#include "transfer/detail/ellipsoid_area.h"
#include "transfer/test_maps.h"

namespace innermap {
namespace {

using test::Draws;

constexpr std::uint64_t kSeed = 11;

Mat3 scaled(double a, double b, double c) { return {{{a, 0, 0}, {0, b, 0}, {0, 0, c}}}; }

Mat3 randomRotation(Draws& draw) {
  return product(test::rotation(6 * draw(), 6 * draw()), test::rotation(6 * draw(), 0));
}

// Stretched by up to three and sheared; turned inside out if asked for.
Mat3 randomJacobian(Draws& draw, bool mirrored) {
  const Mat3 stretch =
      scaled(0.4 + 2 * draw(), 0.4 + 2 * draw(), (mirrored ? -1 : 1) * (0.4 + 2 * draw()));
  return product(randomRotation(draw), product(stretch, randomRotation(draw)));
}

Splat randomSplat(Draws& draw, double thinnest, int degree = 3) {
  Splat s;
  for (int k = 0; k < 3; ++k) s.logScales[k] = -4 + thinnest * draw();
  for (double& q : s.quaternion) q = 3 * draw() - 1.5;
  s.opacity = 4 * draw() - 2;
  s.degree = degree;
  for (int i = 0; i < 3 * ((degree + 1) * (degree + 1) - 1); ++i)
    s.harmonics[static_cast<std::size_t>(i)] = draw() - 0.5;
  return s;
}

// Q diag(exp(scales)) by the quaternion's product q v q*.
Mat3 factorOf(const Splat& s) {
  const auto& q = s.quaternion;
  const double w = q[0], length = w * w + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
  const Vec3 u{q[1], q[2], q[3]};
  Mat3 out;
  for (int k = 0; k < 3; ++k) {
    Vec3 v;
    v[k] = 1;
    const Vec3 turned =
        ((w * w - dot(u, u)) * v + 2 * dot(u, v) * u + 2 * w * cross(u, v)) / length;
    for (int r = 0; r < 3; ++r) out[r][k] = std::exp(s.logScales[k]) * turned[r];
  }
  return out;
}

Mat3 covarianceOf(const Splat& s) {
  const Mat3 f = factorOf(s);
  return product(f, transposed(f));
}

double difference(const Mat3& a, const Mat3& b) {
  double out = 0, size = 0;
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) {
      out = std::max(out, std::abs(a[r][c] - b[r][c]));
      size = std::max(size, std::abs(b[r][c]));
    }
  return out / size;
}

// As render code evaluates it, term by term.
double colourOf(const Splat& s, int colour, const Vec3& direction) {
  const Vec3 d = direction / norm(direction);
  const int each = (s.degree + 1) * (s.degree + 1) - 1;
  double out = 0, values[7];
  const double* k = &s.harmonics[static_cast<std::size_t>(colour * each)];
  for (int l = 1; l <= s.degree; ++l) {
    evaluateHarmonics(l, d, values);
    for (int i = 0; i < 2 * l + 1; ++i) out += *k++ * values[i];
  }
  return out;
}

// By Newton's iteration, R <- (R + R^-T) / 2.
Mat3 polarByNewton(Mat3 r) {
  for (int step = 0; step < 60; ++step) {
    const Mat3 other = transposed(inverse(r));
    for (int i = 0; i < 3; ++i)
      for (int k = 0; k < 3; ++k) r[i][k] = 0.5 * (r[i][k] + other[i][k]);
  }
  return r;
}

TEST(Splats, CovariancesAreCarried) {
  Draws draw(kSeed);
  for (int i = 0; i < 400; ++i) {
    SCOPED_TRACE(::testing::Message() << "splat " << i << " of seed " << kSeed);
    const bool mirrored = i % 3 == 0;
    // Every other one as flat as captures of walls are.
    const Splat s = randomSplat(draw, i % 2 ? 2 : -12);
    const Mat3 j = randomJacobian(draw, mirrored);
    const Splat out = carriedSplat(j, s).splat;
    EXPECT_LT(difference(covarianceOf(out), product(j, product(covarianceOf(s), transposed(j)))),
              1e-9);
    const Splat back = carriedSplat(inverse(j), out).splat;
    EXPECT_LT(difference(covarianceOf(back), covarianceOf(s)), 1e-9);
  }
}

// The least of the scales keeps its digits: the volume is the product.
TEST(Splats, FlatOnesKeepTheirThickness) {
  Draws draw(kSeed);
  for (int i = 0; i < 100; ++i) {
    Splat s = randomSplat(draw, 0);
    s.logScales = {-1, -1.5, -30};
    const Mat3 j = randomJacobian(draw, false);
    const Vec3 out = carriedSplat(j, s).splat.logScales;
    EXPECT_NEAR(out.x + out.y + out.z, -32.5 + std::log(determinant(j)), 1e-9);
  }
  const Splat out = carriedSplat(scaled(2, 3, 4), {.logScales = {0, -1000, 3}}).splat;
  EXPECT_NEAR(out.logScales.x, std::log(2), 1e-12);
  EXPECT_NEAR(out.logScales.y, std::log(3) - 1000, 1e-9);
  EXPECT_NEAR(out.logScales.z, std::log(4) + 3, 1e-12);
}

// Turned rigidly, each axis is the old one turned, in its place, equal scales or not.
TEST(Splats, AxesFollowRotations) {
  Draws draw(kSeed);
  for (int i = 0; i < 100; ++i) {
    Splat s = randomSplat(draw, 1);
    if (i % 2) s.logScales.y = s.logScales.x;
    if (i % 4 == 3) s.logScales.z = s.logScales.x;
    const Mat3 r = randomRotation(draw);
    const Splat out = carriedSplat(r, s).splat;
    EXPECT_LT(difference(factorOf(out), product(r, factorOf(s))), 1e-12) << i;
    const Splat same = carriedSplat(scaled(1, 1, 1), s).splat;
    for (std::size_t k = 0; k < 4; ++k) EXPECT_NEAR(same.quaternion[k], s.quaternion[k], 1e-14);
  }
}

// The colour along R d is what it was along d, mirrored or not.
TEST(Splats, ColoursAreTurned) {
  Draws draw(kSeed);
  for (int i = 0; i < 60; ++i) {
    const Splat s = randomSplat(draw, 1, i % 4);
    const Mat3 j = randomJacobian(draw, i % 2 == 1), r = polarByNewton(j);
    const Splat out = carriedSplat(j, s).splat;
    for (const Vec3& d : test::spherePoints(100, 1))
      for (int colour = 0; colour < 3; ++colour)
        ASSERT_NEAR(colourOf(out, colour, r * d), colourOf(s, colour, d), 1e-12)
            << "splat " << i << " of seed " << kSeed;
  }
}

// The reference's terms, in its order and with its signs.
TEST(Splats, HarmonicsAreTheReferences) {
  const double x = 0.6, y = -0.48, z = 0.64;
  double first[3], second[5], third[7];
  evaluateHarmonics(1, {x, y, z}, first);
  evaluateHarmonics(2, {x, y, z}, second);
  evaluateHarmonics(3, {x, y, z}, third);
  EXPECT_NEAR(first[0], -0.4886025119029199 * y, 1e-15);
  EXPECT_NEAR(first[1], 0.4886025119029199 * z, 1e-15);
  EXPECT_NEAR(first[2], -0.4886025119029199 * x, 1e-15);
  EXPECT_NEAR(second[1], -1.0925484305920792 * y * z, 1e-15);
  EXPECT_NEAR(second[2], 0.31539156525252005 * (3 * z * z - 1), 1e-15);
  EXPECT_NEAR(third[0], -0.5900435899266435 * y * (3 * x * x - y * y), 1e-15);
  EXPECT_NEAR(third[3], 0.3731763325901154 * z * (5 * z * z - 3), 1e-15);
  EXPECT_NEAR(third[6], -0.5900435899266435 * x * (x * x - 3 * y * y), 1e-15);
}

double alphaOf(const Splat& s) { return 1 / (1 + std::exp(-s.opacity)); }

// The mean of the cross sections over directions, by many of them: 2 pi the root of the
// determinant of what is projected.
double meanCrossSection(const Splat& s) {
  const Mat3 covariance = covarianceOf(s), inverted = inverse(covariance);
  double sum = 0;
  const Points directions = test::spherePoints(20000, 1);
  for (const Vec3& d : directions) sum += std::sqrt(determinant(covariance) * dot(d, inverted * d));
  return 2 * kPi * sum / static_cast<double>(directions.size());
}

TEST(Splats, MassKeepsWhatIsDimmed) {
  Draws draw(kSeed);
  for (int i = 0; i < 20; ++i) {
    Splat s = randomSplat(draw, 2);
    s.opacity -= 3;
    const Mat3 j = randomJacobian(draw, i % 2 == 1);
    const CarriedSplat out = carriedSplat(j, s, SplatOpacity::mass);
    ASSERT_FALSE(out.capped);
    EXPECT_NEAR(
        alphaOf(out.splat) * meanCrossSection(out.splat) / (alphaOf(s) * meanCrossSection(s)), 1,
        1e-5);
    EXPECT_NEAR(carriedSplat(inverse(j), out.splat, SplatOpacity::mass).splat.opacity, s.opacity,
                1e-9);
    EXPECT_EQ(carriedSplat(j, s).splat.opacity, s.opacity);
  }
  // Twice as large: a quarter.
  Splat s{.opacity = 1.5};
  EXPECT_NEAR(alphaOf(carriedSplat(scaled(2, 2, 2), s, SplatOpacity::mass).splat), alphaOf(s) / 4,
              1e-15);
}

TEST(Splats, AlphaHasALimit) {
  const auto grown = [](double opacity, double scale) {
    return carriedSplat(scaled(scale, scale, scale), {.opacity = opacity}, SplatOpacity::mass);
  };
  EXPECT_TRUE(grown(0, 0.5).capped);
  EXPECT_NEAR(alphaOf(grown(0, 0.5).splat), 0.99, 1e-12);
  EXPECT_FALSE(grown(0, 0.9).capped);
  EXPECT_FALSE(grown(7, 1).capped);
  EXPECT_NEAR(grown(7, 1).splat.opacity, 7, 1e-12);
  EXPECT_NEAR(grown(7, 0.5).splat.opacity, 7, 1e-15);  // 0.999 already
  EXPECT_NEAR(grown(-900, 2).splat.opacity, -900 - std::log(4), 1e-9);
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_NEAR(alphaOf(grown(infinity, 2).splat), 0.25, 1e-12);
  EXPECT_GT(grown(infinity, 0.5).splat.opacity, 1e300);
  EXPECT_LT(grown(-infinity, 0.5).splat.opacity, -1e300);
}

TEST(Splats, AreasOfEllipsoids) {
  const auto area = [](double a, double b, double c) {
    return std::exp(logEllipsoidArea({std::log(a), std::log(b), std::log(c)}));
  };
  EXPECT_NEAR(area(2, 2, 2) / (16 * kPi), 1, 1e-13);
  const double e = std::sqrt(0.75);
  EXPECT_NEAR(area(1, 0.5, 1) / (2 * kPi * (1 + 0.25 * std::atanh(e) / e)), 1, 1e-13);
  EXPECT_NEAR(area(0.5, 0.5, 1) / (kPi / 2 * (1 + 2 * std::asin(e) / e)), 1, 1e-13);
  EXPECT_NEAR(area(3, 1e-200, 3) / (18 * kPi), 1, 1e-13);
  EXPECT_NEAR(area(1e-60, 1e3, 1e-60) / (kPi * kPi * 1e-57), 1, 1e-12);
}

TEST(Splats, NoShapeNoChange) {
  Draws draw(kSeed);
  const Splat s = randomSplat(draw, 1);
  const double none = std::numeric_limits<double>::quiet_NaN();
  for (const Mat3& j : {scaled(none, 1, 1), scaled(0, 0, 0), scaled(1, 0, 0),
                        scaled(std::numeric_limits<double>::infinity(), 1, 1)}) {
    const Splat out = carriedSplat(j, s, SplatOpacity::mass).splat;
    EXPECT_EQ(out.quaternion, s.quaternion);
    EXPECT_EQ(out.harmonics, s.harmonics);
    EXPECT_EQ(out.logScales.x, s.logScales.x);
  }
  const Splat flat = carriedSplat(scaled(2, 1, 0), s).splat;
  for (int k = 0; k < 3; ++k) EXPECT_TRUE(std::isfinite(flat.logScales[k]));
  for (const double q : flat.quaternion) EXPECT_TRUE(std::isfinite(q));
  for (const double h : flat.harmonics) EXPECT_TRUE(std::isfinite(h));
  const Splat vast = carriedSplat(scaled(1e300, 1e300, 1e300), s).splat;
  EXPECT_NEAR(vast.logScales.x, s.logScales.x + std::log(1e300), 1e-9);
}

}  // namespace
}  // namespace innermap
