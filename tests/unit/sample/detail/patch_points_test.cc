#include "sample/patch_points.h"

#include <gtest/gtest.h>

#include "core/expect.h"
#include "innermap/core/error.h"
#include "innermap/core/run.h"
#include "mesh/shapes.h"

namespace innermap {
namespace {

// Two boxes with a narrow gap between them: x in [0, 1] and [1.02, 2].
Mesh boxesWithGap() {
  Mesh mesh{.name = "boxes"};
  const auto add = [&](double x0, double x1) {
    const int first = static_cast<int>(mesh.vertices.size());
    for (int i = 0; i < 8; ++i)
      mesh.vertices.push_back(
          {i & 1 ? x1 : x0, static_cast<double>(i >> 1 & 1), static_cast<double>(i >> 2)});
    const int faces[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                             {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    for (const auto& f : faces) {
      mesh.triangles.push_back({first + f[0], first + f[1], first + f[2]});
      mesh.triangles.push_back({first + f[0], first + f[2], first + f[3]});
    }
  };
  add(0, 1);
  add(1.02, 2);
  return mesh;
}

double nearestOf(const Points& points, const Vec3& p, std::size_t but) {
  double nearest = 1e300;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (i != but) nearest = std::min(nearest, norm(points[i] - p));
  return nearest;
}

TEST(PatchPoints, SourcesKeepDistanceSpacingAndOutside) {
  const Solid solid(boxesWithGap());
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    PatchSettings s{.spacing = 0.03, .seed = seed};
    const double d = solid.diagonal(), distance = 0.04;
    const Points points = patchSources(solid, {}, distance, {}, s);
    // The area of both boxes over spacing squared, and the shell is larger: at least 0.6 of that.
    EXPECT_GT(points.size(), 0.6 * 10 / (s.spacing * s.spacing * d * d));
    for (std::size_t i = 0; i < points.size(); ++i) {
      EXPECT_FALSE(solid.inside(points[i]));
      EXPECT_NEAR(solid.distance(points[i]), distance * d, 0.031 * distance * d);
      EXPECT_GE(nearestOf(points, points[i], i), s.spacing * d);
    }
  }
}

// A maximal set of points `spacing` apart leaves nothing farther than that from one of them. Darts
// end a little before it.
TEST(PatchPoints, SourcesGoRoundEdgesAndCorners) {
  const Solid solid(boxesWithGap());
  const double d = solid.diagonal(), distance = 0.1, spacing = 0.03;
  const Points points = patchSources(solid, {}, distance, {}, {.spacing = spacing});
  for (const Vec3& outward : {Vec3{-1, -1, -1}, Vec3{-1, 0, -1}, Vec3{0, -1, 1}, Vec3{-1, 1, 0}}) {
    const Vec3 foot{outward.x < 0 ? 0 : 0.5, 0.5 + 0.5 * outward.y, 0.5 + 0.5 * outward.z};
    const Vec3 over = foot + distance * d / norm(outward) * outward;
    EXPECT_LT(nearestOf(points, over, points.size()), 1.5 * spacing * d);
  }
  // Everything is over edges where triangles are far smaller than the distance.
  const Solid ball(shapes::icosphere(4));
  const Points around = patchSources(ball, {}, 0.1, {}, {.spacing = 0.08});
  for (const Vec3& v : shapes::icosphere(2).vertices)
    EXPECT_LT(nearestOf(around, (1 + 0.1 * ball.diagonal()) * v, around.size()),
              1.5 * 0.08 * ball.diagonal());
}

TEST(PatchPoints, NarrowGapsWaitForAShorterDistance) {
  const Solid solid(boxesWithGap());
  const auto inGap = [](const Points& points) {
    return std::count_if(points.begin(), points.end(), [](const Vec3& p) {
      return p.x > 1 && p.x < 1.02 && p.y > 0 && p.y < 1 && p.z > 0 && p.z < 1;
    });
  };
  const Points marks{{1.01, 0.5, 0.5}};
  EXPECT_EQ(inGap(patchSources(solid, marks, 0.02, {}, {.spacing = 0.01, .reach = 0.05})), 0);
  // Fits between the boxes, but over one of them it is too near to the other.
  EXPECT_EQ(inGap(patchSources(solid, marks, 0.006, {}, {.spacing = 0.01, .reach = 0.05})), 0);
  EXPECT_GT(inGap(patchSources(solid, marks, 0.003, {}, {.spacing = 0.01, .reach = 0.05})), 20);
}

TEST(PatchPoints, StayNearMarksAndAwayFromWhatIsThere) {
  const Solid solid(boxesWithGap());
  const double d = solid.diagonal();
  PatchSettings s{.spacing = 0.01, .reach = 0.05};
  const Points marks{{0, 0.5, 0.5}, {2, 1, 1}}, existing{{0, 0.5, 0.5}};
  const std::vector<SurfacePoint> samples = patchSamples(solid, marks, existing, s);
  ASSERT_GT(samples.size(), 50u);
  bool both[2] = {false, false};
  for (const SurfacePoint& sample : samples) {
    const Vec3 p = positionOf(solid.surface(), sample);
    const double first = norm(p - marks[0]), second = norm(p - marks[1]);
    EXPECT_LT(std::min(first, second), s.reach * d);
    EXPECT_GE(norm(p - existing[0]), s.spacing * d);
    both[first < second ? 0 : 1] = true;
  }
  EXPECT_TRUE(both[0] && both[1]);
  for (const Vec3& p : patchSources(solid, marks, 0.0125, {}, s))
    EXPECT_LT(std::min(norm(p - marks[0]), norm(p - marks[1])), (s.reach + 1.1 * 0.0125) * d);
}

TEST(PatchPoints, SameForAnyNumberOfThreadsAndAtMostSoMany) {
  const Solid solid(boxesWithGap());
  PatchSettings s{.spacing = 0.05};
  const auto sources = [&] { return patchSources(solid, {}, 0.05, {}, s); };
  const Points all = sources();
  {
    const ThreadLimit one(1);
    const Points single = sources();
    ASSERT_EQ(all.size(), single.size());
    for (std::size_t i = 0; i < all.size(); ++i) EXPECT_EQ(norm(all[i] - single[i]), 0);
  }
  // A random choice of them: the more lies beyond the gap, where the second half of the triangles
  // is.
  s.most = 40;
  const Points some = sources();
  ASSERT_EQ(some.size(), 40u);
  const auto beyond =
      std::count_if(some.begin(), some.end(), [](const Vec3& p) { return p.x > 1; });
  EXPECT_GT(beyond, 5);
  EXPECT_LT(beyond, 35);
}

TEST(PatchPoints, RefusesBadSettings) {
  const Solid solid(boxesWithGap());
  EXPECT_THROW(patchSources(solid, {}, 0, {}, {}), SettingError);
  EXPECT_THROW(patchSources(solid, {}, 3, {}, {}), SettingError);
  EXPECT_THROW(patchSamples(solid, {}, {}, {.spacing = 0}), SettingError);
  EXPECT_THROW(patchSamples(solid, {}, {}, {.reach = -1}), SettingError);
  test::expectCancels([&] { patchSources(solid, {}, 0.01, {}, {}); });
}

}  // namespace
}  // namespace innermap
