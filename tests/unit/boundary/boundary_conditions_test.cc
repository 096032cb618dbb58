#include "innermap/boundary/boundary_conditions.h"

#include <gtest/gtest.h>

#include <limits>

#include "innermap/boundary/fit_harmonic.h"
#include "innermap/core/error.h"
#include "mesh/shapes.h"

namespace innermap {
namespace {

TEST(BoundaryConditions, WhatDoesNotFitIsRefused) {
  const Mesh mesh = shapes::icosphere(1);
  const SourceBoundary boundary = makeSourceBoundary(mesh);
  BoundaryConditions conditions;
  conditions.values = Matrix(mesh.vertices.size() + 1, 1);
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
  HarmonicFitSettings settings;
  settings.tolerance = 2;
  EXPECT_THROW(fitHarmonic(boundary, conditions, settings), SettingError);
}

}  // namespace
}  // namespace innermap
