// Vertices that a file doubled along seams.
#pragma once

#include <vector>

#include "innermap/mesh/mesh.h"

namespace innermap {

// For each vertex the lowest of those it is one with (itself where there are none): files often
// split vertices where texture coordinates or normals jump, and the solid does not end there. Two
// vertices are one where two boundary edges coincide bit by bit and run in opposite directions;
// vertices that are merely in one place stay apart. #vertices. Indices must be in range.
std::vector<int> joinedVertices(const Points& vertices, const std::vector<Triangle>& triangles);

}  // namespace innermap
