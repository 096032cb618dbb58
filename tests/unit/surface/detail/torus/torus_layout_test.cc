#include "surface/detail/torus/torus_layout.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "core/expect.h"
#include "innermap/core/error.h"
#include "innermap/mesh/mesh_file.h"
#include "surface/handle_shapes.h"

namespace innermap {
namespace {

using shapes::boundaryOf;
using shapes::closed;

// Valid, of the model space's area, with consistent shifts; the layout.
Layout laidOut(const ClosedSurface& surface) {
  const Layout layout = layOutTorus(surface);
  const LayoutQuality quality = layoutQuality(surface.triangles, surface.vertices, layout);
  EXPECT_EQ(quality.flips, 0u);
  EXPECT_NEAR(quality.degree, 1, 1e-9);
  EXPECT_EQ(layout.space, ModelSpace::torus);
  EXPECT_EQ(layout.period[0].y, 0.0);
  EXPECT_NEAR(cross(layout.period[0], layout.period[1]).z, 4 * kPi, 1e-9);
  EXPECT_LE(std::abs(layout.period[1].x), 0.5000001 * layout.period[0].x);
  for (const Vec3& p : layout.place) EXPECT_EQ(p.z, 1.0);
  return layout;
}

// How many periods the layout advances along the vertices of a closed path.
Shift advance(const ClosedSurface& surface, const Layout& layout, const std::vector<int>& path) {
  Shift sum;
  for (std::size_t i = 0; i < path.size(); ++i) {
    const int from = path[i], to = path[(i + 1) % path.size()];
    bool found = false;
    for (std::size_t t = 0; t < surface.triangles.size() && !found; ++t) {
      for (int k = 0; k < 3 && !found; ++k) {
        const int j = (k + 1) % 3;
        if (surface.triangles[t][k] != from || surface.triangles[t][j] != to) continue;
        sum = sum + (layout.shift[t][j] - layout.shift[t][k]);
        found = true;
      }
    }
    EXPECT_TRUE(found) << from << " to " << to;
  }
  return sum;
}

std::vector<int> ring(int i, int m) {
  std::vector<int> path;
  for (int j = 0; j < m; ++j) path.push_back(i * m + j);
  return path;
}

std::vector<int> alongTube(int n, int m) {
  std::vector<int> path;
  for (int i = 0; i < n; ++i) path.push_back(i * m);
  return path;
}

TEST(TorusLayout, MeridiansRunAroundTheTube) {
  for (const auto& [n, m] : {std::pair{7, 3}, {12, 8}, {60, 40}, {8, 60}, {100, 5}}) {
    SCOPED_TRACE(n);
    const ClosedSurface surface = closed(shapes::torus(n, m), 1);
    const Layout layout = laidOut(surface);
    const Shift around = advance(surface, layout, ring(2, m));
    EXPECT_EQ(std::abs(around.a), 1);
    EXPECT_EQ(around.b, 0);
    const Shift along = advance(surface, layout, alongTube(n, m));
    EXPECT_EQ(std::abs(along.b), 1);
    // Seen from outside, the longitude crosses the meridian from right to left.
    EXPECT_EQ(around.a * along.b - around.b * along.a, -1);
  }
}

TEST(TorusLayout, MeridiansOfACavityRunAlongTheTube) {
  const int n = 60, m = 20;
  const ClosedSurface surface = shapes::turnedInsideOut(closed(shapes::torus(n, m), 1));
  const Layout layout = laidOut(surface);
  EXPECT_EQ(advance(surface, layout, alongTube(n, m)).b, 0);
  EXPECT_EQ(std::abs(advance(surface, layout, ring(0, m)).b), 1);
}

TEST(TorusLayout, AreaStaysNearItsShare) {
  const ClosedSurface surface = closed(shapes::torus(90, 40), 1);
  EXPECT_GT(layoutQuality(surface.triangles, surface.vertices, laidOut(surface)).areaRatioLog10,
            -0.3);
  // A ring with a limb four times as long as it is thick, and one of thin long triangles.
  const ClosedSurface limb = boundaryOf(
      shapes::with(
          shapes::without(shapes::block({0, 0, 0}, {8, 8, 2}), shapes::block({3, 3, 0}, {5, 5, 2})),
          shapes::block({9, 3, 0}, {40, 5, 2})),
      1);
  EXPECT_GT(layoutQuality(limb.triangles, limb.vertices, laidOut(limb)).areaRatioLog10, -2);
}

TEST(TorusLayout, KnottedTubesHaveMeridiansToo) {
  for (const auto& curve : {shapes::circle, shapes::trefoil}) {
    const int n = 150, m = 12;
    const ClosedSurface surface = shapes::tube(curve, n, m, 0.3);
    const Layout layout = laidOut(surface);
    EXPECT_EQ(advance(surface, layout, ring(5, m)).b, 0);
  }
  laidOut(boundaryOf(shapes::trefoilCells(), 1));
  laidOut(boundaryOf(shapes::finer(shapes::trefoilCells(), 2), 1));
}

TEST(TorusLayout, KnottedTunnelsAreRefused) {
  const ClosedSurface tunnel = boundaryOf(shapes::knottedTunnel(), 1);
  test::expectRefused<DataError>([&] { layOutTorus(tunnel); }, "knotted");
  // The shell of a cavity along a knot.
  EXPECT_THROW(layOutTorus(shapes::turnedInsideOut(shapes::tube(shapes::trefoil, 150, 12, 0.3))),
               DataError);
}

TEST(TorusLayout, BearsNoiseAndDegenerateTriangles) {
  const ClosedSurface fine = closed(shapes::torus(80, 40), 1);
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    SCOPED_TRACE(seed);
    const ClosedSurface rough = shapes::shaken(fine, 0.02, seed);
    EXPECT_EQ(advance(rough, laidOut(rough), ring(3, 40)).b, 0);
    const ClosedSurface poor = shapes::degenerated(fine, 0.02, seed);
    EXPECT_EQ(advance(poor, laidOut(poor), ring(3, 40)).b, 0);
    const ClosedSurface both = shapes::degenerated(shapes::shaken(fine, 0.06, seed), 0.02, seed);
    EXPECT_EQ(advance(both, laidOut(both), ring(3, 40)).b, 0);
  }
}

TEST(TorusLayout, OtherGeneraAreRefused) {
  EXPECT_THROW(layOutTorus(closed(shapes::icosphere(2), 0)), DataError);
  const ClosedSurface torus = closed(shapes::torus(30, 20), 1);
  test::expectCancels([&] { layOutTorus(torus); });
}

TEST(MeridianCurve, ClosesAfterOneMeridian) {
  const ClosedSurface surface = closed(shapes::torus(60, 24, 1, 0.35), 1);
  const Points curve = meridianCurve(surface, layOutTorus(surface));
  ASSERT_GT(curve.size(), 23u);
  double length = 0;
  for (std::size_t i = 0; i < curve.size(); ++i) {
    length += norm(curve[(i + 1) % curve.size()] - curve[i]);
    EXPECT_NEAR(std::hypot(std::hypot(curve[i].x, curve[i].y) - 1, curve[i].z), 0.35, 0.01);
  }
  EXPECT_NEAR(length, 2 * kPi * 0.35, 0.1);
}

TEST(TorusLayoutModels, RockerArm) {
  const std::string folder = INNERMAP_MODELS;
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is not there";
  const ClosedSurface surface = closed(readMesh(folder + "/rocker-arm.obj"), 1);
  const Layout layout = laidOut(surface);
  EXPECT_GT(layoutQuality(surface.triangles, surface.vertices, layout).areaRatioLog10, -1.2);
  // The meridian goes around the arm beside the hole, which is flat there.
  const Vec3 extent = boundingBox(meridianCurve(surface, layout)).extent();
  EXPECT_LT(norm(extent), 0.35);
}

}  // namespace
}  // namespace innermap
