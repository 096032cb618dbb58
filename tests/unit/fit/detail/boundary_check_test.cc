#include "fit/detail/boundary_check.h"

#include <gtest/gtest.h>

#include "core/expect.h"
#include "fit/test_pairs.h"
#include "innermap/fit/fit_map.h"

namespace innermap {
namespace {

MapFit fitted(const Mesh& source, const Mesh& target) {
  return fitMap(source, target, {.tolerance = 5e-3, .oneToOne = OneToOne::off});
}

BoundaryCheckSettings settingsFor(const MapFit& fit) {
  return {.error = fit.error.max * fit.boundary.target.diagonal};
}

SolidFigures figuresOf(const Mesh& mesh) {
  return injectivityOf(makeBoundaryPair(mesh, mesh)).solid;
}

TEST(BoundaryCheck, PartsAndSurfacesOfTheSolidAreCounted) {
  const auto expect = [](const Mesh& mesh, std::size_t parts, std::size_t surfaces,
                         std::size_t caps, bool overlaps) {
    const SolidFigures found = figuresOf(mesh);
    EXPECT_EQ(found.parts, parts);
    EXPECT_EQ(found.surfaces, surfaces);
    EXPECT_EQ(found.caps, caps);
    EXPECT_EQ(found.overlaps, overlaps);
  };
  const Mesh whole = ball(1);
  const auto two = [&](double apart) {
    return shapes::joined(whole, shapes::transformed(whole, 1, {apart, 0, 0}));
  };
  expect(whole, 1, 1, 0, false);
  expect(two(3), 2, 2, 0, false);
  expect(two(1), 2, 2, 0, true);
  const Mesh cavity = shapes::flipped(shapes::icosphere(1, 0.5, {}));
  expect(shapes::joined(whole, cavity), 1, 2, 0, false);
  Mesh open = whole;
  open.triangles.resize(open.triangles.size() - 4);
  EXPECT_EQ(figuresOf(open).surfaces, 1u);
  EXPECT_GT(figuresOf(open).caps, 0u);
}

TEST(BoundaryCheck, AnAffineMapHasItsDeterminantAndDegreeOne) {
  const Mesh source = ball();
  const MapFit fit = fitted(source, moved(source, affineMap));
  const TargetShape target(fit.boundary);
  const double det = determinant(fit.map.jacobian({0, 0, 0}));
  const DeterminantFigures found =
      boundaryDeterminants(fit.map, fit.boundary, target, settingsFor(fit));
  EXPECT_EQ(found.checked, 10000u);
  EXPECT_EQ(found.folded, 0u);
  EXPECT_NEAR(found.least, det, 1e-6 * det);
  const DegreeFigures degree = boundaryDegree(fit.map, fit.boundary, target, settingsFor(fit));
  EXPECT_NEAR(static_cast<double>(degree.checked), 2000, 100);
  EXPECT_EQ(degree.least, 1);
  EXPECT_EQ(degree.greatest, 1);
}

TEST(BoundaryCheck, AMirrorIsNotFoldedAndHasDegreeOne) {
  const Mesh source = ball();
  const MapFit fit = fitted(source, moved(source, [](const Vec3& p) {
                              return Vec3{p.x, p.y, -2 * p.z};
                            }));
  const TargetShape target(fit.boundary);
  const DeterminantFigures turned =
      boundaryDeterminants(fit.map, fit.boundary, target, settingsFor(fit));
  EXPECT_EQ(turned.folded, 0u);
  EXPECT_GT(turned.least, 0);
  const DegreeFigures degree = boundaryDegree(fit.map, fit.boundary, target, settingsFor(fit));
  EXPECT_EQ(degree.least, 1);
  EXPECT_EQ(degree.greatest, 1);
}

// The lens that two balls share is wound about twice, what one of them has for itself once.
TEST(BoundaryCheck, WhatIsCoveredTwiceHasDegreeTwo) {
  const MapFit fit = fitted(twoBalls(1.5), twoBalls(0.5));
  const TargetShape target(fit.boundary);
  const DegreeFigures degree = boundaryDegree(fit.map, fit.boundary, target, settingsFor(fit));
  EXPECT_GT(degree.checked, 1000u);
  EXPECT_EQ(degree.least, 1);
  EXPECT_EQ(degree.greatest, 2);
}

// Of few triangles, which the map bends: the degree is that of the curved image.
TEST(BoundaryCheck, CoarseMeshesAreSplit) {
  const Mesh source = ball(1);
  MapFit fit = fitted(source, moved(source, harmonicPolynomial));
  BoundaryCheckSettings settings = settingsFor(fit);
  settings.error = 1e-3;
  const TargetShape target(fit.boundary);
  const DegreeFigures degree = boundaryDegree(fit.map, fit.boundary, target, settings);
  EXPECT_EQ(degree.least, 1);
  EXPECT_EQ(degree.greatest, 1);
}

TEST(BoundaryCheck, NoPointIsDeepEnoughForALargeError) {
  const Mesh source = ball();
  const MapFit fit = fitted(source, source);
  BoundaryCheckSettings settings = settingsFor(fit);
  settings.error = 1.1;
  EXPECT_EQ(boundaryDegree(fit.map, fit.boundary, TargetShape(fit.boundary), settings).checked, 0u);
}

TEST(BoundaryCheck, SameForAnyNumberOfThreadsAndCancels) {
  const Mesh source = ball();
  const MapFit fit = fitted(source, moved(source, harmonicPolynomial));
  const TargetShape target(fit.boundary);
  BoundaryCheckSettings settings = settingsFor(fit);
  test::expectSameForThreads(
      [&] { return boundaryDeterminants(fit.map, fit.boundary, target, settings).least; });
  test::expectCancels([&] { boundaryDeterminants(fit.map, fit.boundary, target, settings); });
  test::expectCancels([&] { boundaryDegree(fit.map, fit.boundary, target, settings); });
}

}  // namespace
}  // namespace innermap
