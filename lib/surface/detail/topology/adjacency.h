// Which triangle lies across which edge of a closed manifold mesh.
#pragma once

#include <vector>

#include "innermap/mesh/mesh.h"

namespace innermap {

// For each triangle and corner, the triangle across the edge opposite that corner, which runs from
// corner k + 1 to corner k + 2 (modulo 3), and the corner opposite the edge there.
struct Neighbour {
  int triangle = -1;
  int corner = 0;
};
using Neighbours = std::vector<std::array<Neighbour, 3>>;

// Each edge must have two triangles that run along it in opposite ways; throws DataError otherwise.
Neighbours neighboursOf(const std::vector<Triangle>& triangles);

// The triangles around each vertex: those of vertex v are list[start[v] .. start[v + 1]),
// ascending.
struct VertexTriangles {
  std::vector<int> start, list;
};
VertexTriangles trianglesAround(const std::vector<Triangle>& triangles, std::size_t vertices);

}  // namespace innermap
