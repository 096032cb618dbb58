#include <gtest/gtest.h>

#include <cmath>

#include "core/expect.h"
#include "innermap/core/error.h"
#include "innermap/surface/correspond.h"
#include "mesh/test_meshes.h"
#include "surface/detail/refining/locate.h"

namespace innermap {
namespace {

Points normalised(const Points& points) {
  Points result;
  for (const Vec3& p : points) result.push_back(p / norm(p));
  return result;
}

Points turned(const Points& points, double angle) {
  Points result;
  const double c = std::cos(angle), s = std::sin(angle);
  for (const Vec3& p : points) result.push_back({c * p.x - s * p.y, s * p.x + c * p.y, p.z});
  return result;
}

Mesh scaled(Mesh mesh, const Vec3& factors) {
  for (Vec3& v : mesh.vertices) v = {v.x * factors.x, v.y * factors.y, v.z * factors.z};
  return mesh;
}

// A's shell on B's through layouts on one space: what correspond() hands over.
Correspondence through(const SurfaceShells& a, const Layout& image, const SurfaceShells& b,
                       const Layout& target) {
  Correspondence map;
  ShellCorrespondence shell{
      .surface = a.shells[0], .image = image, .targetSurface = b.shells[0], .targetLayout = target};
  const Locator onB(b.shells[0].triangles, target);
  for (const Vec3& p : image.place) {
    const Located where = onB.find(p);
    shell.onTarget.push_back({where.triangle, onB.barycentric(p, where)});
  }
  shell.positions = interpolate(b.shells[0].vertices, b.shells[0].triangles, shell.onTarget);
  map.source = a.mesh;
  map.positions = shell.positions;
  map.onTarget = shell.onTarget;
  map.shells.push_back(shell);
  return map;
}

Layout onSphere(const Points& places) {
  Layout layout;
  layout.place = normalised(places);
  return layout;
}

// Of torus(n, m): the grid itself, moved by whole steps.
Layout onTorus(const SurfaceShells& surfaces, int n, int m, double stepsU, double stepsV) {
  Layout layout;
  layout.space = ModelSpace::torus;
  layout.period = {Vec3{1, 0, 0}, Vec3{0, 2, 0}};
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < m; ++j)
      layout.place.push_back({(j + stepsV) / m, -2 * (i + stepsU) / n, 1});
  for (const Triangle& t : surfaces.shells[0].triangles) {
    CornerShifts shifts;
    const int i0 = t[0] / m, j0 = t[0] % m;
    for (int k = 0; k < 3; ++k) shifts[k] = {t[k] % m < j0 - 1 ? 1 : 0, t[k] / m < i0 - 1 ? -1 : 0};
    layout.shift.push_back(shifts);
  }
  return layout;
}

TEST(MapQuality, OfAScaledCopyIsPerfect) {
  const SurfaceShells a = closedSurfaces(shapes::icosphere(3));
  const SurfaceShells b = closedSurfaces(shapes::icosphere(3, 5, {7, 8, 9}));
  const Layout layout = onSphere(a.shells[0].vertices);
  const MapQuality q = mapQuality(through(a, layout, b, layout));
  EXPECT_EQ(q.flips, 0u);
  EXPECT_NEAR(q.degree, 1, 1e-12);
  EXPECT_NEAR(q.energyForward, 4, 1e-9);
  EXPECT_NEAR(q.energyBackward, 4, 1e-9);
  EXPECT_NEAR(q.stretch.max, 1, 1e-6);
  EXPECT_NEAR(q.triangleStretch.max, 1, 1e-6);
  EXPECT_EQ(q.invertedTriangles, 0u);
  EXPECT_LT(q.deviation.max, 1e-12);
  EXPECT_LT(q.backDeviation.max, 1e-12);
  EXPECT_EQ(q.imageSelfIntersections, 0u);
  EXPECT_EQ(q.targetSelfIntersections, 0u);
  EXPECT_NEAR(q.unmeasured, 0, 1e-15);
}

TEST(MapQuality, OfAnAffineMapIsItsSingularValues) {
  // Every triangle of the box is moved by diag(2, 1, 1), so J is known on each of its sides.
  const Mesh cube = testing::cube(2, {-1, -1, -1});
  const SurfaceShells a = closedSurfaces(cube), b = closedSurfaces(scaled(cube, {2, 1, 1}));
  const Layout layout = onSphere(cube.vertices);
  const MapQuality q = mapQuality(through(a, layout, b, layout));
  const double r2 = 24.0 / 40.0;  // area of A over that of B
  const auto energy = [&](double s1, double s2) {
    return r2 * (s1 * s1 + s2 * s2) + (1 / (s1 * s1) + 1 / (s2 * s2)) / r2;
  };
  EXPECT_NEAR(q.energyForward, (8 * energy(1, 1) + 16 * energy(2, 1)) / 24, 1e-9);
  EXPECT_NEAR(q.energyBackward, (8 * energy(1, 1) + 32 * energy(2, 1)) / 40, 1e-9);
  EXPECT_NEAR(q.stretch.max, 2 * std::sqrt(r2), 1e-9);
  EXPECT_NEAR(q.triangleStretch.max, 2 * std::sqrt(r2), 1e-9);
}

TEST(MapQualityRelease, OfTheComposedMapIsThatOfItsDifferences) {
  // No triangle of the one lies in one triangle of the other: the derivative of rays counts. The
  // energy is what small triangles of a much finer A have.
  const SurfaceShells a = closedSurfaces(shapes::icosphere(2)),
                      fine = closedSurfaces(shapes::icosphere(6)),
                      b = closedSurfaces(scaled(shapes::icosphere(2), {1.5, 1, 0.7}));
  const Layout target = onSphere(b.shells[0].vertices);
  // The fine sphere's vertices onto flat triangles of A, by rays.
  const Layout coarse = onSphere(turned(a.shells[0].vertices, 0.2));
  SurfaceShells onCoarse = fine;
  {
    const Layout own = onSphere(a.shells[0].vertices);
    const Locator locator(a.shells[0].triangles, own);
    for (Vec3& v : onCoarse.shells[0].vertices) {
      const Located where = locator.find(v);
      const SurfacePoint at{where.triangle, locator.barycentric(v, where)};
      v = interpolate(a.shells[0].vertices, a.shells[0].triangles, {at})[0];
    }
  }
  const Layout finer = onSphere(turned(fine.shells[0].vertices, 0.2));
  const MapQuality q = mapQuality(through(a, coarse, b, target)),
                   reference = mapQuality(through(onCoarse, finer, b, target));
  EXPECT_NEAR(q.energyForward, reference.energyForward, 0.005 * reference.energyForward);
  EXPECT_NEAR(q.energyBackward, reference.energyBackward, 0.005 * reference.energyBackward);
  EXPECT_NEAR(q.stretch.median, reference.stretch.median, 0.01);
  EXPECT_GT(q.energyForward, 4.2);
  EXPECT_GT(q.deviation.max, 1e-3);  // chords of A across B's edges
  EXPECT_GT(q.backDeviation.max, 1e-3);
}

TEST(MapQuality, ForwardOfOneDirectionIsBackwardOfTheOther) {
  const SurfaceShells a = closedSurfaces(shapes::icosphere(2)),
                      b = closedSurfaces(scaled(shapes::icosphere(3), {3, 1, 1}));
  const Layout onA = onSphere(turned(a.shells[0].vertices, 0.7)),
               onB = onSphere(b.shells[0].vertices);
  const MapQuality there = mapQuality(through(a, onA, b, onB)),
                   back = mapQuality(through(b, onB, a, onA));
  EXPECT_NEAR(there.energyForward, back.energyBackward, 0.002 * there.energyForward);
  EXPECT_NEAR(there.energyBackward, back.energyForward, 0.002 * there.energyBackward);
}

TEST(MapQuality, OnTheTorusKnowsThePeriods) {
  const SurfaceShells torus = closedSurfaces(shapes::torus(24, 12));
  const MapQuality q =
      mapQuality(through(torus, onTorus(torus, 24, 12, 5, 0), torus, onTorus(torus, 24, 12, 0, 0)));
  EXPECT_EQ(q.flips, 0u);
  EXPECT_NEAR(q.degree, 1, 1e-9);
  EXPECT_NEAR(q.energyForward, 4, 1e-9);
  EXPECT_NEAR(q.energyBackward, 4, 1e-9);
  EXPECT_NEAR(q.stretch.max, 1, 1e-6);
  const MapQuality half = mapQuality(
      through(torus, onTorus(torus, 24, 12, 5, 6.3), torus, onTorus(torus, 24, 12, 0, 0)));
  EXPECT_EQ(half.flips, 0u);
  EXPECT_GT(half.energyForward, 4.2);
}

TEST(MapQuality, FindsFlipsInvertedTrianglesAndCrossings) {
  const SurfaceShells a = closedSurfaces(shapes::icosphere(2));
  const Layout layout = onSphere(a.shells[0].vertices);
  Correspondence map = through(a, layout, a, layout);
  // One vertex is pulled over the opposite edge of one of its triangles.
  const Triangle t = a.shells[0].triangles[40];
  Layout folded = layout;
  const Vec3 beyond = 0.9 * (layout.place[t[1]] + layout.place[t[2]]) - 0.8 * layout.place[t[0]];
  folded.place[t[0]] = beyond / norm(beyond);
  map = through(a, folded, a, layout);
  const MapQuality q = mapQuality(map);
  EXPECT_GT(q.flips, 0u);
  EXPECT_GT(q.invertedTriangles, 0u);
  EXPECT_NEAR(q.invertedShare, static_cast<double>(q.invertedTriangles) / 320, 1e-12);

  map = through(a, layout, a, layout);
  for (Vec3& p : map.shells[0].positions)
    if (p.z > 0.9) p.z = -1.3;  // the north through the south
  const MapQuality crossed = mapQuality(map);
  EXPECT_GT(crossed.imageSelfIntersections, 0u);
  EXPECT_EQ(crossed.targetSelfIntersections, 0u);
  EXPECT_GT(crossed.deviation.max, 0.05);
  EXPECT_EQ(mapQuality(map, {.selfIntersections = false}).imageSelfIntersections, 0u);
}

TEST(MapQuality, SliversDoNotCount) {
  Mesh mesh = shapes::icosphere(2);
  const SurfaceShells a = closedSurfaces(mesh);
  const Layout layout = onSphere(a.shells[0].vertices);
  mesh.vertices[20] =
      mesh.vertices[mesh.triangles[80][0] == 20 ? mesh.triangles[80][1] : mesh.triangles[80][0]];
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k)
      if (mesh.triangles[t][k] == 20)
        mesh.vertices[20] = mesh.vertices[mesh.triangles[t][(k + 1) % 3]];
  const SurfaceShells b = closedSurfaces(mesh);
  const MapQuality q = mapQuality(through(a, layout, b, layout));
  EXPECT_GT(q.unmeasured, 0);
  EXPECT_LT(q.unmeasured, 0.02);
  EXPECT_LT(q.energyForward, 5);
  EXPECT_LT(q.energyBackward, 5);
}

TEST(MapQuality, CanBeCancelledAndChecksItsSettings) {
  const SurfaceShells a = closedSurfaces(shapes::icosphere(1));
  const Layout layout = onSphere(a.shells[0].vertices);
  const Correspondence map = through(a, layout, a, layout);
  EXPECT_THROW(mapQuality(map, {.samples = 0}), SettingError);
  test::expectCancels([&] { mapQuality(map, {.samples = 10}); });
}

}  // namespace
}  // namespace innermap
