// Meshes that are nothing but crossings.
#pragma once

#include <cstddef>

#include "innermap/mesh/mesh.h"

namespace innermap {

// Throws DataError where more than 16 pairs of triangles a triangle pass through each other (a body
// in clothes that cross its skin has 0.2): a ball of paper has no shape that a map could keep, and
// taking it apart takes minutes.
void refuseTangle(const Mesh& mesh, std::size_t crossings);

}  // namespace innermap
