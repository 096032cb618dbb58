#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "innermap/core/error.h"
#include "innermap/fit/fit_harmonic.h"
#include "mesh/shapes.h"

namespace innermap {
namespace {

TEST(BoundaryConditions, WhatDoesNotFitIsRefused) {
  const Mesh mesh = shapes::icosphere(1);
  const SourceBoundary boundary = makeSourceBoundary(mesh);
  BoundaryConditions conditions{.values = Matrix(mesh.vertices.size() + 1, 1)};
  EXPECT_THROW(fitHarmonic(boundary, conditions), DataError);
  conditions.values = Matrix(mesh.vertices.size(), 0);
  EXPECT_THROW(fitHarmonic(boundary, conditions), DataError);
  conditions.values = Matrix(mesh.vertices.size(), 1);
  conditions.free.assign(mesh.triangles.size(), 1);
  EXPECT_THROW(fitHarmonic(boundary, conditions), DataError);
  conditions.free.resize(3);
  EXPECT_THROW(fitHarmonic(boundary, conditions), DataError);
  conditions.free.clear();
  conditions.values(5, 0) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(fitHarmonic(boundary, conditions), DataError);
  conditions.values(5, 0) = 0;
  conditions.flux = Matrix(mesh.triangles.size(), 2);
  EXPECT_THROW(fitHarmonic(boundary, conditions), DataError);
  conditions.flux = Matrix();
  EXPECT_THROW(fitHarmonic(boundary, conditions, {.tolerance = 2}), SettingError);
}

Matrix column(const std::vector<double>& values) {
  Matrix out(values.size(), 1);
  for (std::size_t i = 0; i < values.size(); ++i) out(i, 0) = values[i];
  return out;
}

TEST(BoundaryConditions, OfGroups) {
  const Mesh mesh = shapes::icosphere(1);
  const SurfaceGroup top{"top", {0, 1}}, low{"low", {7}}, none{"none", {}}, far{"far", {1000}};
  BoundaryConditions c = valuesOnGroups(mesh, {top, low}, column({1, 2}));
  ASSERT_EQ(c.free.size(), mesh.triangles.size());
  for (std::size_t t = 0; t < c.free.size(); ++t) {
    EXPECT_EQ(c.free[t], t != 0 && t != 1 && t != 7);
    for (std::size_t corner = 0; corner < 3; ++corner)
      EXPECT_DOUBLE_EQ(c.values(3 * t + corner, 0), t < 2 ? 1 : t == 7 ? 2 : 0);
  }
  setFluxes(mesh, {{"side", {7, 8}}}, column({-3}), c);
  EXPECT_EQ(c.free[7], 1);
  EXPECT_DOUBLE_EQ(c.flux(7, 0), -3);
  EXPECT_DOUBLE_EQ(c.flux(8, 0), -3);
  EXPECT_DOUBLE_EQ(c.flux(9, 0), 0);
  // A triangle of two groups: one value, or none.
  EXPECT_NO_THROW(valuesOnGroups(mesh, {top, top}, column({1, 1})));
  EXPECT_THROW(valuesOnGroups(mesh, {top, top}, column({1, 2})), DataError);
  EXPECT_THROW(valuesOnGroups(mesh, {none}, column({1})), DataError);
  EXPECT_THROW(valuesOnGroups(mesh, {far}, column({1})), DataError);
  EXPECT_THROW(valuesOnGroups(mesh, {top}, column({1, 2})), DataError);
  EXPECT_THROW(setFluxes(mesh, {far}, column({1}), c), DataError);
}

TEST(BoundaryConditions, OfWeights) {
  const Mesh mesh = shapes::icosphere(1);
  const SurfaceGroup top{"top", {0, 1}}, low{"low", {7}};
  const BoundaryConditions c = weightConditions(mesh, {top, low});
  ASSERT_EQ(c.values.columns(), 2u);
  EXPECT_DOUBLE_EQ(c.values(0, 0), 1);
  EXPECT_DOUBLE_EQ(c.values(0, 1), 0);
  EXPECT_DOUBLE_EQ(c.values(21, 1), 1);
  EXPECT_THROW(weightConditions(mesh, {top}), DataError);
  EXPECT_THROW(weightConditions(mesh, {top, top}), DataError);
}

TEST(BoundaryConditions, OfVerticesThatAreNotAllKnown) {
  const Mesh mesh = shapes::icosphere(1);
  Matrix values(mesh.vertices.size(), 1);
  values(3, 0) = std::numeric_limits<double>::quiet_NaN();
  const BoundaryConditions c = valuesAtVertices(mesh, values);
  for (std::size_t t = 0; t < c.free.size(); ++t) {
    const Triangle& corners = mesh.triangles[t];
    EXPECT_EQ(c.free[t], std::count(corners.begin(), corners.end(), 3));
  }
  EXPECT_THROW(valuesAtVertices(mesh, Matrix(3, 1)), DataError);
}

// Two halves of a ball, one channel each, that touch along the equator, whose vertices may be there
// twice.
struct Halves {
  Mesh mesh;
  BoundaryConditions conditions;
};

Halves halves(bool apart) {
  Halves out{.mesh = shapes::icosphere(2)};
  const int count = static_cast<int>(out.mesh.vertices.size());
  if (apart) {
    const Points copy = out.mesh.vertices;
    out.mesh.vertices.insert(out.mesh.vertices.end(), copy.begin(), copy.end());
  }
  out.conditions.values = Matrix(3 * out.mesh.triangles.size(), 2);
  for (std::size_t t = 0; t < out.mesh.triangles.size(); ++t) {
    const bool upper =
        positionOf(out.mesh, {static_cast<int>(t), {1.0 / 3, 1.0 / 3, 1.0 / 3}}).z > 0;
    for (std::size_t c = 0; c < 3; ++c) {
      out.conditions.values(3 * t + c, upper ? 0 : 1) = 1;
      if (apart && upper) out.mesh.triangles[t][c] += count;
    }
  }
  return out;
}

TEST(BoundaryConditions, JumpsBecomeContinuousAndKeepTheirSum) {
  for (const bool apart : {false, true}) {
    Halves h = halves(apart);
    const double share = removeJumps(h.mesh, h.conditions);
    // Some triangles on both sides of the equator, of 320 in 16 rows or so.
    EXPECT_GT(share, 0.05);
    EXPECT_LT(share, 0.3);
    ASSERT_EQ(h.conditions.values.rows(), h.mesh.vertices.size());
    for (const Triangle& triangle : h.mesh.triangles)
      for (const int vertex : triangle) {
        const auto v = static_cast<std::size_t>(vertex);
        EXPECT_NEAR(h.conditions.values(v, 0) + h.conditions.values(v, 1), 1, 1e-14);
        const double z = h.mesh.vertices[v].z, value = h.conditions.values(v, 0);
        if (std::abs(z) > 0.4) {
          EXPECT_NEAR(value, z > 0, 1e-14);
        } else if (std::abs(z) < 1e-9) {
          EXPECT_NEAR(value, 0.5, 0.2);  // the icosphere is its own mirror image
        }
      }
    EXPECT_TRUE(fitHarmonic(makeSourceBoundary(h.mesh), h.conditions, {.tolerance = 1e-2}).met);
  }
}

TEST(BoundaryConditions, ValuesWithoutJumpsStay) {
  Halves h = halves(false);
  h.conditions.values = Matrix(h.conditions.values.rows(), 1);
  EXPECT_NEAR(removeJumps(h.mesh, h.conditions), 0, 1e-15);
  const Matrix before = h.conditions.values;  // now one row a vertex
  EXPECT_EQ(removeJumps(h.mesh, h.conditions), 0);
  EXPECT_EQ(h.conditions.values.rows(), before.rows());
  h.conditions.values = Matrix(h.mesh.vertices.size() + 1, 2);
  EXPECT_THROW(removeJumps(h.mesh, h.conditions), DataError);
}

}  // namespace
}  // namespace innermap
