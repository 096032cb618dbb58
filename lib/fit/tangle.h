// Boundaries are checked for crossings, and refused where they are nothing else.
#pragma once

#include <cstddef>

#include "innermap/mesh/check.h"
#include "innermap/mesh/mesh.h"

namespace innermap {

// checkMesh() with so many crossings placed as a target's overlaps are told by.
MeshReport checkCrossings(const Mesh& mesh);

// Pairs that cross, a triangle: a body in clothes that cross its skin has 0.2.
constexpr std::size_t kMostCrossings = 16;

// Throws DataError where more cross: a ball of paper has no shape that a map could keep, and taking
// it apart takes minutes. crossings: pairs of its triangles that pass through each other.
void refuseTangle(const Mesh& mesh, std::size_t crossings);

}  // namespace innermap
