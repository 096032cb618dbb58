#include "surface/detail/handles/glued_map.h"

#include <gtest/gtest.h>

#include "core/expect.h"
#include "innermap/core/error.h"
#include "surface/detail/refining/target_metric.h"
#include "surface/handle_shapes.h"

namespace innermap {
namespace {

using namespace shapes;

// Corners rounded.
ClosedSurface rounded(ClosedSurface surface, int steps) {
  for (int i = 0; i < steps; ++i) {
    Points sum(surface.vertices.size());
    std::vector<double> count(surface.vertices.size(), 0);
    for (const Triangle& t : surface.triangles)
      for (int k = 0; k < 3; ++k) {
        sum[t[k]] += surface.vertices[t[(k + 1) % 3]];
        count[t[k]] += 1;
      }
    for (std::size_t v = 0; v < sum.size(); ++v)
      surface.vertices[v] = 0.5 * (surface.vertices[v] + sum[v] / count[v]);
  }
  return surface;
}

// Valid, glued along the cuts, and of bounded stretch. Images of A's vertices.
Points expectMap(const ClosedSurface& a, const ClosedSurface& b, double most,
                 const GluedMapSettings& settings = {}) {
  const HandleLoops loopsOfA = handleLoops(a), loopsOfB = handleLoops(b);
  const CutPair pair = cutAlike(loopsOfA, loopsOfB, {.landmarks = settings.landmarks});
  const GluedMap map = gluedMap(pair, settings);
  const LayoutQuality quality =
      layoutQuality(map.cut.surface.triangles, map.cut.surface.vertices, map.image);
  EXPECT_EQ(quality.flips, 0u);
  EXPECT_NEAR(quality.degree, 1, 1e-9);
  EXPECT_EQ(map.onTarget.size(), a.vertices.size());
  // Both copies of a rim's vertex lie at one point of B, and rims on rims.
  const TargetMetric target(pair.b.surface, pair.layoutOfB);
  const double size = boundingBox(b.vertices).diagonal();
  std::vector<SurfacePoint> images;
  for (const Vec3& p : map.image.place) {
    const Located where = target.locator().find(p);
    images.push_back({where.triangle, target.locator().barycentric(p, where)});
  }
  const std::vector<SurfacePoint> uncut = onUncut(pair.b, images);
  for (const CutHandle& handle : map.cut.handles)
    for (std::size_t i = 0; i < handle.loop[0].size(); ++i) {
      const Vec3 left = pointOn(b, uncut[handle.loop[0][i]]);
      EXPECT_LT(norm(left - pointOn(b, uncut[handle.loop[1][i]])), 1e-9 * size);
      const int v = map.cut.vertexOf[handle.loop[0][i]];
      if (v >= 0) {
        EXPECT_LT(norm(left - pointOn(b, map.onTarget[v])), 1e-9 * size);
      }
    }
  // No vertex of A beside the caps is in one of B's.
  for (std::size_t t = 0; t < map.cut.surface.triangles.size(); ++t) {
    if (map.cut.triangleOf[t] < 0) continue;
    Vec3 middle;
    for (int k = 0; k < 3; ++k) middle += map.image.place[map.cut.surface.triangles[t][k]] / 3.0;
    EXPECT_GE(pair.b.triangleOf[static_cast<std::size_t>(
                  target.locator().find(middle / norm(middle)).triangle)],
              0);
  }
  Points out;
  for (const SurfacePoint& p : map.onTarget) out.push_back(pointOn(b, p));
  const double scale =
      std::sqrt(surfaceArea(a.vertices, a.triangles) / surfaceArea(b.vertices, b.triangles));
  for (const Triangle& t : a.triangles)
    for (int k = 0; k < 3; ++k)
      EXPECT_LT(scale * norm(out[t[k]] - out[t[(k + 1) % 3]]),
                most * norm(a.vertices[t[k]] - a.vertices[t[(k + 1) % 3]]));
  return out;
}

TEST(GluedMap, OntoTheSameShapeIsNearlyIsometric) {
  const ClosedSurface a = rounded(plate(2, 2), 2), b = rounded(plate(2, 3), 3);
  expectMap(a, b, 3);
}

TEST(GluedMapRelease, BetweenDifferentShapes) {
  const ClosedSurface a = rounded(plate(2, 2), 2);
  const ClosedSurface b =
      rounded(boundaryOf(without(block({0, 0, 0}, {10, 4, 4}),
                                 with(block({1, 1, 0}, {3, 3, 4}), block({6, 0, 1}, {8, 4, 3}))),
                         2),
              1);
  expectMap(a, b, 12);
  expectMap(b, a, 12);
}

TEST(GluedMapRelease, OfThreeHandles) {
  const ClosedSurface a = rounded(plate(3, 2), 2);
  const ClosedSurface b =
      rounded(boundaryOf(with(shapes::plateCells(3), block({0, 0, 2}, {2, 0, 6})), 3), 1);
  expectMap(a, b, 12);
}

TEST(GluedMapRelease, MeetsLandmarks) {
  const ClosedSurface a = rounded(plate(2, 2), 2), b = rounded(plate(2, 3), 3);
  const CutPair pair = cutAlike(handleLoops(a), handleLoops(b));
  const GluedMap free = gluedMap(pair);
  std::vector<char> onRim(a.vertices.size(), 0);
  for (const CutHandle& handle : pair.a.handles)
    for (const int v : handle.loop[0]) onRim[v] = 1;
  GluedMapSettings settings;
  for (std::size_t v = 11; settings.landmarks.size() < 4; v += 131)
    if (!onRim[v]) settings.landmarks.push_back({static_cast<int>(v), free.onTarget[v + 1]});
  const GluedMap map = gluedMap(pair, settings);
  EXPECT_EQ(layoutQuality(map.cut.surface.triangles, map.cut.surface.vertices, map.image).flips,
            0u);
  for (const auto& [v, p] : settings.landmarks)
    EXPECT_LT(norm(pointOn(b, map.onTarget[v]) - pointOn(b, p)), 1e-9);
  settings.landmarks[0].first = pair.a.handles[0].loop[0][0];
  EXPECT_THROW(gluedMap(pair, settings), DataError);
}

TEST(GluedMap, CanBeCancelled) {
  const CutPair pair = cutAlike(handleLoops(plate(2)), handleLoops(plate(2, 2)));
  test::expectCancels([&] { gluedMap(pair, {}); });
}

}  // namespace
}  // namespace innermap
