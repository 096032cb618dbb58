#include "fit/detail/shape_path.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/pi.h"
#include "mesh/shapes.h"

namespace innermap {
namespace {

constexpr double kRounding = 1e-9;

double mostApart(const Points& a, const Points& b) {
  double most = 0;
  for (std::size_t i = 0; i < a.size(); ++i) most = std::max(most, norm(a[i] - b[i]));
  return most;
}

Points mapped(const Points& points, const ScaledMotion& motion) {
  Points out;
  for (const Vec3& p : points) out.push_back(motion(p));
  return out;
}

Mat3 turnAboutZ(double angle) {
  return {
      {{std::cos(angle), -std::sin(angle), 0}, {std::sin(angle), std::cos(angle), 0}, {0, 0, 1}}};
}

// A long box, subdivided by being a ball stretched to one.
Mesh bar(double thickness = 1) {
  Mesh mesh = shapes::icosphere(3);
  for (Vec3& p : mesh.vertices) p = {4 * p.x, thickness * p.y, 0.7 * thickness * p.z};
  return mesh;
}

TEST(ShapePath, BeginsAndEndsExactly) {
  const Mesh from = bar();
  Points to = from.vertices;
  for (Vec3& p : to) p = {p.x + 0.2 * p.y * p.y, p.y - 0.1 * p.x * p.x, 2 * p.z};
  const ShapePath path(from.vertices, to, from.triangles, 1.26);
  EXPECT_EQ(mostApart(path.at(0), from.vertices), 0);
  EXPECT_LT(mostApart(mapped(path.at(1), path.rest()), to), kRounding);
  // And continuously: just before the end, nearly there.
  EXPECT_LT(mostApart(path.at(1 - 1e-6), path.at(1)), 1e-4);
}

TEST(ShapePath, LeavesOutSimilarities) {
  const Mesh from = bar();
  const ScaledMotion motion{2.5, turnAboutZ(2), {10, -3, 4}};
  const ShapePath path(from.vertices, mapped(from.vertices, motion), from.triangles, 2.5);
  EXPECT_LT(mostApart(path.at(0.5), from.vertices), 1e-8);
  EXPECT_NEAR(path.rest().scale, 2.5, 1e-12);
  EXPECT_LT(norm(path.rest()({1, 2, 3}) - motion({1, 2, 3})), 1e-9);
}

// A bar coiled up by `angle`: half way it is coiled by half of it, not squashed, so its middle line
// is as long as before. In the last case its ends turn by more than half a turn each, beyond
// the shortest logarithm.
TEST(ShapePath, TurnsInsteadOfCuttingAcross) {
  for (const double angle : {kPi, 2.4 * kPi}) {
    SCOPED_TRACE("angle " + std::to_string(angle));
    const Mesh from = bar(kPi / angle);
    const auto coiled = [](const Vec3& p, double by) {
      const double radius = 8 / by, along = by * p.x / 8;
      return Vec3{(radius - p.y) * std::sin(along), radius - (radius - p.y) * std::cos(along), p.z};
    };
    Points to = from.vertices, half = to;
    for (std::size_t i = 0; i < to.size(); ++i) {
      to[i] = coiled(from.vertices[i], angle);
      half[i] = coiled(from.vertices[i], angle / 2);
    }
    const ShapePath path(from.vertices, to, from.triangles, 1);
    const Points middle = path.at(0.5);
    std::size_t left = 0, right = 0;
    for (std::size_t i = 0; i < to.size(); ++i) {
      if (from.vertices[i].x < from.vertices[left].x) left = i;
      if (from.vertices[i].x > from.vertices[right].x) right = i;
    }
    const double apart = norm(middle[left] - middle[right]),
                 wanted = norm(half[left] - half[right]);
    EXPECT_NEAR(apart, wanted, 0.05 * wanted);
  }
}

TEST(MovedBy, MovesTheField) {
  Affine affine{{0.5, 0, 0}, Matrix(4, 3)};
  for (std::size_t i = 0; i < 12; ++i) affine.coefficients.data()[i] = 1 / (1.0 + i);
  Matrix weights(2, 3);
  for (std::size_t i = 0; i < 6; ++i) weights.data()[i] = std::sin(i + 1.0);
  const HarmonicField field({{2, 0, 0}, {0, 3, 1}}, weights, affine);
  const ScaledMotion motion{0.5, turnAboutZ(0.7), {1, 2, 3}};
  const HarmonicField movedField = movedBy(motion, field);
  const Points at{{0.1, 0.2, 0.3}, {-1, 0.5, 0}};
  const Matrix before = field.evaluate(at).values, after = movedField.evaluate(at).values;
  for (std::size_t i = 0; i < at.size(); ++i) {
    const Vec3 wanted = motion({before(i, 0), before(i, 1), before(i, 2)});
    EXPECT_LT(norm(wanted - Vec3{after(i, 0), after(i, 1), after(i, 2)}), 1e-13);
  }
}

}  // namespace
}  // namespace innermap
