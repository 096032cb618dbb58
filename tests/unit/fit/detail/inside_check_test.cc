#include "fit/detail/inside_check.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>

#include "core/pi.h"
#include "field/affine_map.h"
#include "fit/test_pairs.h"

namespace innermap {
namespace {

TEST(InsideCheck, PointsFillTheSolid) {
  const Solid ball(shapes::icosphere(4));
  const Points points = pointsInside(ball, 20000);
  // Of a lattice as many lie inside as the volume has cells, but for some of those that the surface
  // cuts: 4 pi r^2 of them at a radius of cbrt(20000 3 / 4 pi) = 17 cells, a few hundredths.
  EXPECT_NEAR(static_cast<double>(points.size()), 20000, 400);
  Vec3 middle;
  for (const Vec3& p : points) {
    EXPECT_TRUE(ball.inside(p));
    middle += p / static_cast<double>(points.size());
  }
  EXPECT_LT(norm(middle), 0.01);
}

TEST(InsideCheck, PointsFillAPlateThinnerThanTheirSpacing) {
  const Points points = pointsInside(Solid(shapes::box({-1, -1, -2e-3}, {1, 1, 2e-3})), 1000);
  // Each of 6,400 cubes with a probability of 0.16: a standard deviation of 29.
  EXPECT_NEAR(static_cast<double>(points.size()), 1000, 150);
  const auto outer = std::count_if(points.begin(), points.end(),
                                   [](const Vec3& p) { return std::abs(p.z) > 1e-3; });
  EXPECT_NEAR(static_cast<double>(outer) / static_cast<double>(points.size()), 0.5, 0.1);
}

// Its box has 120 million cubes: 2,000 of them are the needle's, along the diagonal.
TEST(InsideCheck, TheBoxOfANeedleIsNotLookedThrough) {
  const Vec3 along = Vec3{1, 1, 1} / std::sqrt(3.0);
  const double radius = 1e-3, length = 1;
  std::atomic<std::size_t> asked = 0;
  const auto beside = [&](const Vec3& p) {
    const double t = std::clamp(dot(p, along), 0.0, length);
    return norm(p - t * along) - radius;
  };
  const double step = std::cbrt(kPi * radius * radius * length / 2000);
  const Points points =
      stratifiedPoints({{0, 0, 0}, along}, step,
                       {[&](const Vec3& p) { return ++asked, beside(p) < 0; },
                        [&](const Vec3& p, double distance) { return beside(p) < distance; }});
  EXPECT_NEAR(static_cast<double>(points.size()), 2000, 200);
  EXPECT_LT(asked, 1000000u);
}

TEST(InsideCheck, DeterminantsMultiply) {
  const Points points{{0, 0, 0}, {0.5, 0.25, 0}};
  MappedPoints here = mapPoints(test::affineMap({{{2, 0, 0}, {0, 1, 0}, {0, 0, 1}}}, {1, 0, 0}),
                                {points, {}}, 1e-9);
  here = mapPoints(test::affineMap({{{1, 0, 0}, {0, -3, 0}, {0, 0, 1}}}), here, 1e-9);
  EXPECT_NEAR(here.determinants[1], -6, 1e-12);
  EXPECT_LT(norm(here.points[1] - Vec3{2, -0.75, 0}), 1e-12);
  EXPECT_EQ(foldedShare(here.determinants, 1), 1);
  EXPECT_EQ(foldedShare(here.determinants, -1), 0);
  EXPECT_EQ(foldedShare({1, -1, 0, 2}, 1), 0.5);
}

TEST(InsideCheck, FoldsAreCounted) {
  const Mesh mesh = ball(2);
  const TargetShape target(makeBoundaryPair(mesh, mesh));
  const DeterminantFigures found =
      determinantsOf({{{0, 0, 0}, {0.5, 0, 0}, {0, 0.5, 0}}, {2, -0.5, 0}}, target, 0);
  EXPECT_EQ(found.checked, 3u);
  EXPECT_EQ(found.folded, 2u);
  EXPECT_EQ(found.foldedAtOverlap, 0u);
  EXPECT_EQ(found.least, -0.5);
}

TEST(InsideCheck, OutsideIsBeyondTheSlack) {
  const Mesh mesh = ball(4);
  const TargetShape target(makeBoundaryPair(mesh, mesh));
  const Points points{{0, 0, 0}, {0, 0, 1.05}, {0, 0, 1.5}, {3, 0, 0}};
  EXPECT_EQ(outsideShare(points, target, 0), 0.75);
  EXPECT_EQ(outsideShare(points, target, 0.1), 0.5);
}

}  // namespace
}  // namespace innermap
