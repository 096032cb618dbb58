// Edges, seams and boundary loops of triangle meshes, manifold or not.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "innermap/core/vec3.h"
#include "innermap/mesh/mesh.h"

namespace innermap {

class DisjointSets {
 public:
  explicit DisjointSets(std::size_t count);
  int find(int i);
  void unite(int i, int j);  // the lower representative stays

 private:
  std::vector<int> parent_;
};

// One side of a triangle.
struct EdgeUse {
  int low = 0, high = 0;  // its vertices
  int triangle = 0;
  std::int8_t corner = 0;  // runs from this corner to the next
  bool forward = true;     // runs from low to high
};

inline bool hasRepeatedVertex(const Triangle& t) {
  return t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
}

// The sides of all triangles without a repeated vertex, sorted by (low, high, triangle).
std::vector<EdgeUse> sortedEdges(const std::vector<Triangle>& triangles);

// Calls visit(begin, end) for each edge: the range of its uses.
void forEachEdge(const std::vector<EdgeUse>& edges,
                 const std::function<void(const EdgeUse*, const EdgeUse*)>& visit);

// For each vertex the lowest of those it is joined with. Vertices are joined where two boundary
// edges coincide bit by bit and run in opposite directions: files often split vertices along
// texture seams, and the solid does not end there. `seamEdges` receives the number of edges closed.
std::vector<int> joinSeams(const Points& vertices, const std::vector<Triangle>& triangles,
                           std::size_t* seamEdges = nullptr);

std::vector<Triangle> mapped(const std::vector<Triangle>& triangles, const std::vector<int>& to);

using DirectedEdge = std::array<int, 2>;

// Splits edges into simple loops (no vertex twice). Directed: as many edges must leave each vertex
// as enter it. Undirected: each vertex must have an even number.
std::vector<std::vector<int>> traceLoops(const std::vector<DirectedEdge>& edges, bool directed);

// The edges that caps must have: for each edge that n triangles more run one way than the other, n
// times the other way. In and out balance at every vertex.
std::vector<DirectedEdge> cappingEdges(const std::vector<EdgeUse>& edges);

// The loop's centroid, weighted by length: (vertex, weight), weights sum to 1.
std::vector<std::pair<int, double>> loopCentroid(const Points& vertices,
                                                 const std::vector<int>& loop);
Vec3 weightedSum(const Points& vertices, const std::vector<std::pair<int, double>>& weights);

// Six times the signed volume of the cone from `apex` over a triangle.
inline double coneVolume6(const Vec3& apex, const Vec3& a, const Vec3& b, const Vec3& c) {
  return dot(a - apex, cross(b - apex, c - apex));
}

}  // namespace innermap
