#include "innermap/fit/surface_problem.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/expect.h"
#include "innermap/field/fit.h"
#include "mesh/shapes.h"

namespace innermap {
namespace {

constexpr double kUnit = 2;  // extent of the values

// A harmonic function at points of the ball's surface, and the points beside it.
SurfaceValues polynomial(const Solid& solid) {
  return [solid](const std::vector<SurfacePoint>& samples) {
    const Points at = interpolate(solid.surface().vertices, solid.surface().triangles, samples);
    Matrix values(at.size(), 1);
    for (std::size_t i = 0; i < at.size(); ++i)
      values(i, 0) = at[i].x * at[i].x - at[i].y * at[i].y + at[i].y * at[i].z;
    return values;
  };
}

double rmsAtFreshPoints(const HarmonicField& field, const Solid& solid) {
  const BoundarySamples fresh = freshSamples(solid, polynomial(solid));
  return measureBoundaryError(field, fresh.points, fresh.values, kUnit).rms;
}

TEST(SurfaceProblem, FieldOnAShellMeetsAPolynomial) {
  const Solid solid(shapes::icosphere(3));
  const FitProblem problem =
      surfaceProblem(solid, polynomial(solid), {.collocation = 1200, .heldOut = 500});
  EXPECT_EQ(problem.surface.points.size(), 1200u);
  EXPECT_EQ(problem.surface.values.rows(), 1200u);
  EXPECT_EQ(problem.surface.heldOut.size(), 500u);
  EXPECT_LT(
      rmsAtFreshPoints(
          fitField(problem, {.sources = 300, .interpolation = Interpolation::linear}).field, solid),
      1e-5);
}

TEST(SurfaceProblem, AdaptiveFieldMeetsItsTolerance) {
  const Solid solid(shapes::icosphere(3));
  const AdaptiveResult fit =
      fitToTolerance(adaptiveProblem(solid, polynomial(solid), kUnit), {.tolerance = 1e-3});
  EXPECT_EQ(fit.end, AdaptiveEnd::met);
  EXPECT_LE(fit.error.p99, 1e-3);
  EXPECT_LT(rmsAtFreshPoints(fit.field, solid), 1e-3);
}

// Charges about a needle stand farther away than it is thick, so that their shell is many times its
// surface.
TEST(SurfaceProblemRelease, NeedlesHaveMorePointsThanCharges) {
  Mesh needle = shapes::icosphere(3);
  for (Vec3& p : needle.vertices) p = {p.x, 2e-3 * p.y, 2e-3 * p.z};
  const Solid solid(needle);
  const AdaptiveResult fit =
      fitToTolerance(adaptiveProblem(
                         solid,
                         [&](const std::vector<SurfacePoint>& samples) {
                           const Points at = interpolate(solid.surface().vertices,
                                                         solid.surface().triangles, samples);
                           Matrix values(at.size(), 1);
                           for (std::size_t i = 0; i < at.size(); ++i)
                             values(i, 0) = std::sin(200 * at[i].x);
                           return values;
                         },
                         1),
                     {.firstSources = 100, .maxSources = 5000});
  EXPECT_GT(fit.rounds.size(), 1u);
  for (const AdaptiveRound& round : fit.rounds) EXPECT_GT(round.collocation, round.sources);
  EXPECT_LT(fit.error.p99, 0.1);
}

TEST(SurfaceProblem, SetsOfOneSeedShareNoPoint) {
  const Solid solid(shapes::icosphere(2));
  const FitProblem problem =
      surfaceProblem(solid, polynomial(solid), {.collocation = 200, .heldOut = 200, .seed = 7});
  const Points other = freshSamples(solid, polynomial(solid), {.count = 300, .seed = 7}).points;
  ASSERT_EQ(other.size(), 300u);
  for (const Points* set : {&problem.surface.points, &problem.surface.heldOut})
    for (const Vec3& p : *set)
      for (const Vec3& q : other) ASSERT_GT(norm(p - q), 0);
}

TEST(SurfaceProblem, FreshSamplesAreTheFirstDrawOfTheAdaptiveProblem) {
  const Solid solid(shapes::icosphere(2));
  const Points a = freshSamples(solid, polynomial(solid), {.count = 50, .seed = 3}).points,
               b = adaptiveProblem(solid, polynomial(solid), kUnit, {.seed = 3}).draw(50, 0).points;
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_EQ(norm(a[i] - b[i]), 0);
}

TEST(SurfaceProblem, Cancels) {
  const Solid solid(shapes::icosphere(2));
  const auto values = polynomial(solid);
  test::expectCancels([&] { surfaceProblem(solid, values, {}); });
}

}  // namespace
}  // namespace innermap
