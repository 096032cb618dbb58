// Which triangles a solid is made of.
#pragma once

#include <cstddef>
#include <vector>

#include "innermap/mesh/mesh.h"

namespace innermap {

struct CleanTriangles {
  std::vector<int> kept;                                              // ascending
  std::size_t repeatedVertex = 0, duplicates = 0, oppositePairs = 0;  // left out
};

// Leaves out triangles with a repeated vertex and, of triangles with the same three vertices and
// orientation, all but the first. Of two that are opposite, both are left out: they enclose nothing
// and cancel in the winding number. But where each of the three sides has exactly one triangle
// more, the two fill a place of the surface that needs one; there the first is kept.
CleanTriangles cleanTriangles(const std::vector<Triangle>& triangles);

}  // namespace innermap
