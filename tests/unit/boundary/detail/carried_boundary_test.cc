#include "innermap/boundary/detail/carried_boundary.h"

#include <gtest/gtest.h>

#include "mesh/shapes.h"

namespace innermap {
namespace {

// p -> p + shift, and what a charge at (0, 0, 2) adds.
HarmonicMap bending(const Vec3& shift, double weight) {
  Affine affine;
  affine.coefficients = Matrix(4, 3);
  for (int r = 0; r < 3; ++r) {
    affine.coefficients(0, r) = shift[r];
    affine.coefficients(1 + r, r) = 1;
  }
  Matrix weights(1, 3);
  weights(0, 0) = weight;
  return HarmonicMap(HarmonicField({{0, 0, 2}}, weights, affine));
}

class Carried : public ::testing::Test {
 protected:
  Carried() : solid(shapes::icosphere(3)) { settings.chord = 1e-3; }

  Points ways(const Vec3& way) const { return Points(solid.repaired().mesh.vertices.size(), way); }

  Solid solid;
  CarrySettings settings;
};

TEST_F(Carried, TheFirstProblemIsOfTheSource) {
  const CarriedBoundary boundary(solid, settings);
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
  // Back by a few fixed point iterations: both maps are a shift and a little more.
  const auto back = [](const HarmonicMap& map, const Vec3& y) {
    Vec3 x = y;
    for (int i = 0; i < 200; ++i) x = x + (y - map(x));
    return x;
  };
  const BoundarySamples samples = problem.draw(300, 2);
  for (std::size_t i = 0; i < samples.points.size(); ++i) {
    const Vec3 source = back(first, back(second, samples.points[i]));
    EXPECT_LT(solid.distance(source), 1e-6);
    EXPECT_NEAR(samples.values(i, 2), samples.points[i].z + 1, 1e-12);
  }
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
