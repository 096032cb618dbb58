// What is known of a harmonic field on the surface of its solid.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "innermap/core/matrix.h"
#include "innermap/core/setting.h"
#include "innermap/core/vec3.h"
#include "innermap/mesh/mesh.h"

namespace innermap {

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

// What harmonic weights are made from: of each group a channel, 1 on it and 0 on the others. Throws
// as above; DataError for less than two groups.
BoundaryConditions weightConditions(const Mesh& mesh, const std::vector<SurfaceGroup>& groups);

// Makes values continuous that are given three a triangle, as no harmonic field meets a jump: each
// vertex takes the mean of the corners about it whose value is given, weighted by their angles, so
// that channels keep their sum, and `values` becomes one row a vertex. Returns the share of the
// surface whose values that changes: triangles along the jumps. Throws DataError for sizes that do
// not fit the mesh.
double removeJumps(const Mesh& mesh, BoundaryConditions& conditions);

}  // namespace innermap
