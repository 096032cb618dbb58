// Harmonic fields of a solid from what is known on its surface: values on some of it, fluxes
// (derivatives along the outward normal) on the rest.
//
// The field is an affine function plus point charges outside the solid, as for maps (see
// fit_map.h), fitted to both kinds of conditions at once by least squares. A flux counts as the
// change of value that it makes on the way to the nearest place whose value is given: that is what
// an error of it comes to, and near the border of the two parts, where the field goes as the root
// of the distance and its flux grows without bound, it stays small. Charges are added where the
// error is, until 99% of the boundary lies within a tolerance.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "innermap/core/matrix.h"
#include "innermap/core/setting.h"
#include "innermap/core/vec3.h"
#include "innermap/field/field_file.h"
#include "innermap/field/fit.h"
#include "innermap/field/harmonic_field.h"
#include "innermap/fit/boundary_pair.h"
#include "innermap/mesh/mesh.h"

namespace innermap {

// What is known of a harmonic field on the surface of its solid.

// What is known of K channels on a mesh; of all channels at the same places.
struct BoundaryConditions {
  // #vertices x K, or 3 #triangles x K (corner c of triangle t in row 3 t + c), which lets values
  // jump from one triangle to the next. Linear on triangles. Not looked at where a flux is given.
  Matrix values;
  // In place of `values`, if given: #points x K at points of the surface, where values are exact
  // between the vertices too. Called from one thread at a time, with one point at least.
  std::function<Matrix(const Points& points)> function;
  std::vector<std::uint8_t> free;  // #triangles: 1 where the flux is given; empty: nowhere
  Matrix flux;  // #triangles x K, values' units per world unit, constant on each; empty: 0
  // In place of `flux`, if given: #points x K, from points of the surface and outward unit normals.
  std::function<Matrix(const Points& points, const Points& normals)> fluxFunction;
  // Degrees, in [0, 90]. Where triangles meet at a smaller angle they stand for a smooth surface:
  // fluxes are along normals that are interpolated between the vertices (weights of N. Max,
  // "Weights for Computing Vertex Normals from Facet Normals", 1999, exact on a sphere). Along the
  // triangles' own normals the flux of a smooth field jumps at each edge, and charges would crowd
  // there for nothing. 0: the triangles' own.
  double creaseAngle = 30;
  // Channels are to sum up to 1 everywhere: what they lack is shared among them equally. Each stays
  // harmonic, and moves by no more than the sum was off.
  bool unitSum = false;
};

// Of BoundaryConditions::creaseAngle.
Setting creaseSetting(double* angle);

// A part of a surface.
struct SurfaceGroup {
  std::string name;
  std::vector<int> triangles;  // of the mesh, ascending
};

// values: #vertices x K, NaN where a vertex has none: the triangles about it are free. Throws
// DataError for another number of rows.
BoundaryConditions valuesAtVertices(const Mesh& mesh, Matrix values);

// Row g of `values` (#groups x K) on group g, at the corners of its triangles; nothing flows
// through the rest of the surface. Throws DataError for a group without triangles, which cannot
// hold a value, for triangles that are in two groups of other values or not in the mesh.
BoundaryConditions valuesOnGroups(const Mesh& mesh, const std::vector<SurfaceGroup>& groups,
                                  const Matrix& values);

// Row g of `flux` (#groups x K) through group g, in place of its values. Throws as above.
void setFluxes(const Mesh& mesh, const std::vector<SurfaceGroup>& groups, const Matrix& flux,
               BoundaryConditions& conditions);

// What harmonic weights are made from: of each group a channel, 1 on it and 0 on the others, that
// sum up to 1. Throws as above; DataError for less than two groups.
BoundaryConditions weightConditions(const Mesh& mesh, const std::vector<SurfaceGroup>& groups);

// Makes values continuous if they are given three a triangle, as no harmonic field meets a jump:
// each vertex takes the mean of the corners about it whose value is given, weighted by their
// angles, so that channels keep their sum, and `values` becomes one row a vertex. Returns the share
// of the surface whose values that changes: triangles along the jumps. Throws DataError for sizes
// that do not fit the mesh.
double removeJumps(const Mesh& mesh, BoundaryConditions& conditions);
std::string joinedText(double share);  // what that did, in words; nothing of 0

constexpr double kWeightsTolerance = 1e-2;  // where groups touch, a finer one is spent on kinks

struct HarmonicFitSettings {
  double tolerance = 1e-3;  // of the largest span of a channel's values
  std::size_t maxSources = 100000;
  std::uint64_t seed = 1;
};

std::vector<Setting> describe(HarmonicFitSettings& settings);

struct HarmonicFit {
  HarmonicField field;
  double span = 0;  // the largest of a channel's given values, their units
  // Fractions of the span, at 20,000 random points of the boundary that took no part in the fit and
  // where the largest error was looked for (see certify): of the values where they are given, and
  // elsewhere of the flux, times the distance to the nearest place whose value is given. Without
  // fluxes error.bound is how far the field can be off anywhere inside (maximum principle).
  BoundaryError error;
  // About the largest error of a value anywhere inside, fluxes included: the value that those
  // errors would give if they were all of one sign (comparison principle; Protter and Weinberger,
  // "Maximum Principles in Differential Equations", 1984, 2.6). Fraction of the span.
  double bound = 0;
  bool met = false;  // error.p99 is within the tolerance
  AdaptiveEnd end = AdaptiveEnd::met;
  double freeShare = 0;  // of the area where the flux is given
  std::size_t sources = 0, collocation = 0;
  std::vector<std::string> notes, warnings;
  StageSeconds seconds;  // "fit", "certificate"
};

// boundary: the mesh of the conditions (its `mesh` counts vertices and triangles). Surfaces that
// close its holes take the mean of their rim's values where no flux is given anywhere, and no flux
// else. Throws SettingError, DataError (sizes that do not fit, values that are not finite, no place
// with a value, no room for charges), MemoryError, Cancelled. Deterministic for a seed, whatever
// the number of threads.
HarmonicFit fitHarmonic(const SourceBoundary& boundary, const BoundaryConditions& conditions,
                        const HarmonicFitSettings& settings = {});

// A harmonic field together with the solid that it fills: what its file holds.

struct SolidField {
  HarmonicField field;
  SourceBoundary boundary;
  std::vector<std::string> names;  // of the channels
  // As its file says it: version, source, channels, span, seed, tolerance, tolerance_met,
  // boundary_error_rms, boundary_error_p99, boundary_error_max, boundary_error_samples,
  // inside_error_bound, free_share.
  Facts facts;
};

// The facts of a fit. names: of its channels, without commas or line breaks. Throws DataError for
// other names or another number of them.
Facts harmonicFacts(const HarmonicFit& fit, const HarmonicFitSettings& settings,
                    const std::string& source, const std::vector<std::string>& names);

// One PLY, see field_file.h; `innermap info` describes it. Throws FileError when it cannot be
// written; it appears whole or not at all.
void writeSolidField(const std::string& path, const SolidField& field);

// Reads it and makes the solid again. Throws FileError for what is not the file of a field with its
// boundary, DataError as makeSourceBoundary does, Cancelled.
SolidField readSolidField(const std::string& path);

// Whether facts are those of a field, and not of a map.
bool tellOfField(const Facts& facts);

}  // namespace innermap
