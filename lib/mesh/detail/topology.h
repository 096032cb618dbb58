// Boundary loops of triangle meshes and the caps that close them.
#pragma once

#include <array>
#include <utility>
#include <vector>

#include "innermap/core/vec3.h"
#include "innermap/mesh/mesh.h"
#include "mesh/connectivity.h"

namespace innermap {

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
