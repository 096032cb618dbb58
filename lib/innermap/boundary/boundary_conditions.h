// What is known of a harmonic field on the surface of its solid.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "innermap/core/matrix.h"
#include "innermap/core/vec3.h"

namespace innermap {

// What is known of K channels on a mesh; of all channels at the same places.
struct BoundaryConditions {
  // #vertices x K, or 3 #triangles x K (corner c of triangle t in row 3 t + c), which lets values
  // jump from one triangle to the next. Linear on triangles. Not looked at where a flux is given.
  Matrix values;
  // In place of `values`, if given: #points x K at points of the surface, where values are exact
  // between the vertices too. Called from one thread at a time.
  std::function<Matrix(const Points& points)> function;
  std::vector<std::uint8_t> free;  // #triangles: 1 where the flux is given; empty: nowhere
  Matrix flux;  // #triangles x K, values' units per world unit, constant on each; empty: 0
  // In place of `flux`, if given: #points x K, from points of the surface and outward unit normals.
  std::function<Matrix(const Points& points, const Points& normals)> fluxFunction;
};

}  // namespace innermap
