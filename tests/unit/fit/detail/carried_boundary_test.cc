#include "fit/detail/carried_boundary.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "field/affine_map.h"
#include "fit/detail/inside_check.h"
#include "fit/test_pairs.h"

namespace innermap {
namespace {

// p -> p + shift, and what a charge at (0, 0, 2) adds.
HarmonicMap bending(const Vec3& shift, double weight) {
  Matrix weights(1, 3);
  weights(0, 0) = weight;
  return HarmonicMap(HarmonicField({{0, 0, 2}}, weights, test::affineOf(test::kIdentity, shift)));
}

// By fixed point iterations: of maps that are a shift and a little more.
Vec3 preimage(const HarmonicMap& map, const Vec3& y) {
  Vec3 x = y;
  for (int i = 0; i < 200; ++i) x = x + (y - map(x));
  return x;
}

class Carried : public ::testing::Test {
 protected:
  Carried() : solid(shapes::icosphere(3)) { settings.chord = 1e-3; }

  Points ways(const Vec3& way) const { return Points(solid.repaired().mesh.vertices.size(), way); }

  Solid solid;
  CarriedSettings settings;
};

TEST_F(Carried, TheFirstProblemIsOfTheSource) {
  CarriedBoundary boundary(solid, settings);
  const AdaptiveProblem problem = boundary.problem(ways({1, 2, 3}), solid.diagonal());
  const BoundarySamples samples = problem.draw(500, 1);
  ASSERT_EQ(samples.points.size(), 500u);
  for (std::size_t i = 0; i < 500; ++i) {
    EXPECT_LT(solid.distance(samples.points[i]), 1e-12);
    EXPECT_NEAR(samples.values(i, 1), samples.points[i].y + 2, 1e-12);
  }
}

// Samples are exact images, not points of the mesh between images of vertices.
TEST_F(Carried, LaterOnesAreOfTheImage) {
  CarriedBoundary boundary(solid, settings);
  const HarmonicMap first = bending({0.5, 0, 0}, 0.4), second = bending({0, 0.3, 0}, -0.2);
  boundary.advance(first, false);
  boundary.advance(second, false);
  EXPECT_EQ(boundary.steps().size(), 2u);
  const AdaptiveProblem problem = boundary.problem(ways({0, 0, 1}), solid.diagonal());
  const BoundarySamples samples = problem.draw(300, 2);
  for (std::size_t i = 0; i < samples.points.size(); ++i) {
    const Vec3 source = preimage(first, preimage(second, samples.points[i]));
    EXPECT_LT(solid.distance(source), 1e-6);
    EXPECT_NEAR(samples.values(i, 2), samples.points[i].z + 1, 1e-12);
  }
}

TEST_F(Carried, PiecesTellThatTheShapeRunsThroughItself) {
  CarriedBoundary boundary(solid, settings);
  EXPECT_DOUBLE_EQ(boundary.pieces(), 1);
  boundary.advance(bending({0.5, 0, 0}, 0.4), false);
  EXPECT_DOUBLE_EQ(boundary.pieces(), 1);
  const Solid touching(
      shapes::joined(shapes::icosphere(3), shapes::icosphere(3, 1, {1.95, 0.01, 0.02})));
  EXPECT_GT(CarriedBoundary(touching, settings).pieces(), 1.01);
}

// The points are 0.1 short of where they should be.
TEST_F(Carried, WaysMakeUpForWhatIsOff) {
  CarriedBoundary boundary(solid, settings);
  boundary.advance(bending({0.5, 0, 0}, 0), false);
  Points from = solid.repaired().mesh.vertices;
  for (Vec3& p : from) p.x += 0.6;
  struct Case {
    Mending mending;
    double made;
  };
  for (const auto& [mending, made] : {Case{{from, 0, 1}, 0.1},
                                      {{from, 0.04, 1}, 0.06},
                                      {{from, 0.04, 0.03}, 0.03},
                                      {{from, 0.2, 1}, 0},
                                      {{from, 0, 1, 0.15}, 0.05},
                                      {{from, 0, 1, 0.08}, 0}}) {
    const AdaptiveProblem problem = boundary.problem(ways({0, 0, 1}), solid.diagonal(), mending);
    PlacementRequest everywhere;
    everywhere.spacing = everywhere.reach = 0.05;
    everywhere.most = 1000;
    for (const BoundarySamples& samples :
         {problem.draw(300, 3), problem.placeCollocation(everywhere)}) {
      ASSERT_FALSE(samples.points.empty());
      for (std::size_t i = 0; i < samples.points.size(); ++i) {
        EXPECT_NEAR(samples.values(i, 0), samples.points[i].x + made, 1e-9);
        EXPECT_NEAR(samples.values(i, 2), samples.points[i].z + 1, 1e-9);
      }
    }
  }
}

using CarriedRelease = Carried;

// Two steps, not exact: within the chord of the exact ones, which every triangle's edges keep to.
TEST_F(Carried, PointsToFitToMayBeNearlyExact) {
  CarriedBoundary boundary(solid, settings);
  boundary.advance(bending({0.5, 0, 0}, 0.4), false);
  boundary.advance(bending({0, 0.3, 0}, -0.2), false);
  PlacementRequest request;
  request.spacing = 0.05;
  request.reach = 0.1;
  request.most = 5000;
  const auto points = [&](bool exact) {
    const AdaptiveProblem problem = boundary.problem(ways({0, 0, 1}), solid.diagonal(), {}, exact);
    return problem.placeCollocation(request).points;
  };
  const Points exact = points(true), near = points(false);
  ASSERT_EQ(exact.size(), near.size());
  ASSERT_GT(exact.size(), 100u);
  std::vector<double> off;
  for (std::size_t i = 0; i < exact.size(); ++i) off.push_back(norm(near[i] - exact[i]));
  std::sort(off.begin(), off.end());
  EXPECT_LT(off.back(), settings.chord);
  EXPECT_LT(off[off.size() / 2], 0.1 * settings.chord);
  EXPECT_GT(off.back(), 10 * settings.accuracy);
}

// The mesh about the image is coarse: where it lies within the image, charges as near to it as it
// is off would stand inside.
TEST_F(CarriedRelease, NoChargeStandsInsideTheExactImage) {
  settings.chord = 10;
  const Solid coarse(shapes::icosphere(1));
  CarriedBoundary boundary(coarse, settings);
  const HarmonicMap map = bending({0, 0, 0}, 0.8);
  boundary.advance(map, false);
  const Points still(coarse.repaired().mesh.vertices.size());
  const AdaptiveProblem problem = boundary.problem(still, coarse.diagonal());
  for (const double distance : {0.02, 0.004, 0.0012}) {
    PlacementRequest request;
    request.most = 100000;
    request.spacing = std::max(0.02, distance);
    request.reach = distance;
    const Points charges = problem.placeSources(request, distance);
    EXPECT_FALSE(charges.empty()) << "where the image is straight";
    for (const Vec3& charge : charges)
      EXPECT_FALSE(coarse.inside(preimage(map, charge))) << distance;
  }
}

// The mesh about the image knows its edges; a bump in the middle of a triangle only points that
// errors are measured at tell of.
TEST_F(Carried, NoChargeTouchesABumpBetweenTheEdges) {
  settings.chord = 0.01;
  const Solid coarse(shapes::icosphere(1));
  const auto& [i, j, k] = coarse.surface().triangles[0];
  const Points& v = coarse.surface().vertices;
  const Vec3 middle = (v[i] + v[j] + v[k]) / 3, up = middle / norm(middle);
  Matrix weights(1, 3);
  for (int a = 0; a < 3; ++a) weights(0, static_cast<std::size_t>(a)) = 6e-4 * up[a];
  const HarmonicField bump({middle + 0.02 * up}, weights, test::affineOf(test::kIdentity, {}));
  CarriedBoundary boundary(coarse, settings);
  boundary.advance(HarmonicMap(bump), false);
  const Points still(coarse.repaired().mesh.vertices.size());
  const AdaptiveProblem problem = boundary.problem(still, coarse.diagonal());
  const double away = 0.034;
  PlacementRequest request;
  request.marks = {middle};
  request.spacing = 0.2 * away / coarse.diagonal();
  request.reach = 3 * away / coarse.diagonal();
  request.most = 100000;
  const auto placed = [&] { return problem.placeSources(request, away / coarse.diagonal()); };
  const Points before = placed(), images = problem.draw(50000, 1).points;
  const auto nearest = [&](const Points& charges) {
    double out = 1;
    for (const Vec3& charge : charges)
      for (const Vec3& p : images) out = std::min(out, norm(p - charge));
    return out;
  };
  EXPECT_LT(nearest(before), 0.4 * away);
  EXPECT_GE(nearest(placed()), 0.4 * away);
}

// Steps whose boundary values are those of harmonic polynomials: what they compose to is known
// inside. With the error e of the whole and e1, e2 of what the steps before the last leave, the
// maximum principle in each step's own solid bounds the error inside by e + 2 L (e1 + e2), L the
// polynomials' Lipschitz constants together; and ways are linear between vertices, which cuts off
// an eighth of the squared edge times the largest second derivative, three times.
TEST_F(CarriedRelease, KnownHarmonicStepsCompose) {
  constexpr double kTolerance = 1e-3, kLipschitz = 1.4 * 1.4, kSecond = 0.25;
  const Mesh source = shapes::icosphere(5);
  double edge = 0;
  for (const Triangle& t : source.triangles)
    edge = std::max(edge, norm(source.vertices[t[0]] - source.vertices[t[1]]));
  const double chord = 3 * edge * edge / 8 * kSecond * kLipschitz;
  const std::vector<Vec3 (*)(const Vec3&)> maps{
      harmonicPolynomial,
      [](const Vec3& p) {
        return Vec3{p.x + 0.1 * p.y * p.z, p.y - 0.08 * (p.x * p.x - p.z * p.z), 1.1 * p.z};
      },
      [](const Vec3& p) {
        return Vec3{p.x - 0.1 * p.z, p.y + 0.1 * p.x * p.y, p.z + 0.06 * (p.y * p.y - p.x * p.x)};
      }};
  const Solid round(source);
  CarriedBoundary boundary(round, settings);
  Points shape = source.vertices;
  double before = 0;
  BoundaryError error;
  for (std::size_t s = 0; s < maps.size(); ++s) {
    before += error.max;
    Points ways;
    for (Vec3& p : shape) {
      ways.push_back(maps[s](p) - p);
      p = maps[s](p);
    }
    const AdaptiveResult fit = fitToTolerance(boundary.problem(ways, 1), {.tolerance = kTolerance});
    boundary.advance(HarmonicMap(fit.field), s + 1 == maps.size());
    error = boundary.errorFrom(shape, 1);
  }
  std::vector<double> errors;
  const ComposedMap map(boundary.steps());
  for (const Vec3& p : pointsInside(round, 3000)) {
    Vec3 exact = p;
    for (const auto& step : maps) exact = step(exact);
    errors.push_back(norm(map(p) - exact));
  }
  std::sort(errors.begin(), errors.end());
  EXPECT_LE(error.p99, 2 * kTolerance);
  EXPECT_LT(errors[errors.size() * 99 / 100], error.max + chord);
  EXPECT_LT(errors.back(), error.max + 2 * kLipschitz * before + chord);
}

TEST_F(Carried, ErrorsAreThoseOfTheWholeWay) {
  CarriedBoundary boundary(solid, settings);
  Points shape = solid.repaired().mesh.vertices;
  EXPECT_LT(boundary.errorFrom(shape, 1).max, 1e-14);
  boundary.advance(bending({0.5, 0, 0}, 0), false);
  boundary.advance(bending({0, 0.25, 0}, 0), true);
  for (Vec3& p : shape) p = p + Vec3{0.5, 0.25, 0.01};
  const BoundaryError error = boundary.errorFrom(shape, 2);
  EXPECT_EQ(error.samples, kFreshSamples);
  EXPECT_NEAR(error.rms, 0.005, 1e-9);
  EXPECT_NEAR(error.max, 0.005, 1e-9);
}

}  // namespace
}  // namespace innermap
