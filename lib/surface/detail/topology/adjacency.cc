#include "surface/detail/topology/adjacency.h"

#include <algorithm>

#include "innermap/core/error.h"

namespace innermap {

VertexTriangles trianglesAround(const std::vector<Triangle>& triangles, std::size_t vertices) {
  VertexTriangles out;
  out.start.assign(vertices + 1, 0);
  for (const Triangle& t : triangles)
    for (const int v : t) ++out.start[v + 1];
  for (std::size_t v = 0; v < vertices; ++v) out.start[v + 1] += out.start[v];
  out.list.resize(3 * triangles.size());
  std::vector<int> next(out.start.begin(), out.start.end() - 1);
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (const int v : triangles[t]) out.list[next[v]++] = static_cast<int>(t);
  return out;
}

Neighbours neighboursOf(const std::vector<Triangle>& triangles) {
  int vertices = 0;
  for (const Triangle& t : triangles) vertices = std::max({vertices, t[0] + 1, t[1] + 1, t[2] + 1});
  const VertexTriangles around = trianglesAround(triangles, static_cast<std::size_t>(vertices));
  const auto across = [&](int from, int to) {
    Neighbour found;
    for (int i = around.start[from]; i < around.start[from + 1]; ++i) {
      const int t = around.list[i];
      for (int k = 0; k < 3; ++k) {
        if (triangles[t][(k + 1) % 3] != from || triangles[t][(k + 2) % 3] != to) continue;
        if (found.triangle >= 0) throw DataError("an edge has more than two triangles");
        found = {t, k};
      }
    }
    if (found.triangle < 0) throw DataError("an edge has one triangle only");
    return found;
  };
  Neighbours out(triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (int k = 0; k < 3; ++k)
      out[t][k] = across(triangles[t][(k + 2) % 3], triangles[t][(k + 1) % 3]);
  return out;
}

}  // namespace innermap
