#include <gtest/gtest.h>

#include <cmath>

#include "core/expect.h"
#include "innermap/core/error.h"
#include "innermap/tetra/hexahedralize.h"
#include "mesh/shapes.h"

namespace innermap {
namespace {

// A cube of one hexahedron.
CellMesh cube(double lower, double upper) {
  CellMesh mesh{.name = "cube"};
  for (int i = 0; i < 8; ++i)
    mesh.vertices.push_back({i & 1 ? upper : lower, i & 2 ? upper : lower, i & 4 ? upper : lower});
  mesh.hexahedra = {{0, 1, 3, 2, 4, 5, 7, 6}};
  return mesh;
}

TEST(BoundaryFit, IsNothingOnTheSurface) {
  const BoundaryFit fit = boundaryFit(cube(0, 1), Solid(shapes::box({0, 0, 0}, {1, 1, 1})));
  EXPECT_EQ(fit.faces, 12u);
  EXPECT_EQ(fit.inward, 0u);
  EXPECT_LT(fit.toSurface.max, 1e-12);
  EXPECT_LT(fit.fromSurface.max, 1e-12);
}

TEST(BoundaryFit, IsTheDistanceBothWays) {
  const BoundaryFit fit = boundaryFit(cube(0.1, 0.9), Solid(shapes::box({0, 0, 0}, {1, 1, 1})));
  const double diagonal = std::sqrt(3.0);
  EXPECT_NEAR(fit.toSurface.rms, 0.1 / diagonal, 1e-12);
  // Corners of the larger cube are farther from the smaller one.
  EXPECT_GT(fit.fromSurface.max, 0.15 / diagonal);
  EXPECT_LE(fit.fromSurface.max, 0.1 + 1e-12);
}

TEST(BoundaryFit, CountsFacesThatFaceInwards) {
  CellMesh mesh = cube(0, 1);
  mesh.hexahedra[0] = {4, 5, 7, 6, 0, 1, 3, 2};
  EXPECT_EQ(boundaryFit(mesh, Solid(shapes::box({0, 0, 0}, {1, 1, 1}))).inward, 12u);
}

TEST(BoundaryFit, RefusesNothing) {
  const Solid solid(shapes::box({0, 0, 0}, {1, 1, 1}));
  EXPECT_THROW(boundaryFit({}, solid), DataError);
  EXPECT_THROW(boundaryFit(cube(0, 1), solid, {.samples = 0}), SettingError);
  test::expectCancels([&] { boundaryFit(cube(0, 1), solid, {.samples = 100}); });
}

}  // namespace
}  // namespace innermap
