// How triangles hang together: their edges, manifold or not, and the vertices that files doubled.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "innermap/mesh/mesh.h"

namespace innermap {

inline bool hasRepeatedVertex(const Triangle& t) {
  return t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
}

// One side of a triangle: one use of the edge between two vertices.
struct EdgeUse {
  int low = 0, high = 0;  // its vertices
  int triangle = 0;
  std::int8_t corner = 0;  // in 0..2; the side runs from this corner to the next
  bool forward = true;     // runs from low to high

  int side() const { return 3 * triangle + corner; }
};

// The sides of all triangles without a repeated vertex, sorted by (low, high, triangle): the uses
// of one edge are neighbours. The same for any number of threads.
std::vector<EdgeUse> sortedEdges(const std::vector<Triangle>& triangles);

// Calls visit(begin, end) for each edge of sortedEdges(), in order: the range of its uses. One use
// is a boundary edge, two of opposite directions are what a closed manifold has, more are none.
void forEachEdge(const std::vector<EdgeUse>& edges,
                 const std::function<void(const EdgeUse* begin, const EdgeUse* end)>& visit);

// Of each triangle the first one of its piece: what hangs together by edges of just two triangles.
// (Solids that touch along an edge do not: each may be mapped in its own way.) -1 of one with a
// repeated vertex. #triangles.
std::vector<int> piecesByEdges(const std::vector<Triangle>& triangles);

// For each vertex the lowest of those it is one with (itself where there are none): files often
// split vertices where texture coordinates or normals jump, and the solid does not end there. Two
// vertices are one where two boundary edges coincide bit by bit and run in opposite directions;
// vertices that are merely in one place stay apart. #vertices. Indices must be in range.
// `seamEdges` receives the number of edges closed.
std::vector<int> joinedVertices(const Points& vertices, const std::vector<Triangle>& triangles,
                                std::size_t* seamEdges = nullptr);

// The triangles with such vertices made one.
std::vector<Triangle> joinedTriangles(const Points& vertices,
                                      const std::vector<Triangle>& triangles,
                                      std::size_t* seamEdges = nullptr);

}  // namespace innermap
