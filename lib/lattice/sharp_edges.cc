#include "lattice/sharp_edges.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/pi.h"

namespace innermap {
namespace {

constexpr double kTurn = 60;  // degrees: two sharp edges that meet at more make a corner

struct Graph {
  std::vector<std::vector<int>> next;  // of each vertex, along sharp edges
};

std::vector<int> welded(const Points& vertices) {
  std::map<std::array<double, 3>, int> first;
  std::vector<int> name(vertices.size());
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    const Vec3& p = vertices[v];
    name[v] = first.try_emplace({p.x, p.y, p.z}, static_cast<int>(v)).first->second;
  }
  return name;
}

Graph graphOf(const Mesh& surface, double angle) {
  const std::vector<int> name = welded(surface.vertices);
  std::map<std::pair<int, int>, std::vector<int>> triangles;
  for (std::size_t t = 0; t < surface.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      const int a = name[surface.triangles[t][k]], b = name[surface.triangles[t][(k + 1) % 3]];
      if (a != b) triangles[std::minmax(a, b)].push_back(static_cast<int>(t));
    }
  Graph graph;
  graph.next.resize(surface.vertices.size());
  const double least = std::cos(angle * kPi / 180);
  for (const auto& [edge, beside] : triangles) {
    if (beside.size() != 2) continue;
    const Vec3 a = areaVector(surface, beside[0]), b = areaVector(surface, beside[1]);
    if (!(dot(a, b) < least * norm(a) * norm(b))) continue;
    graph.next[edge.first].push_back(edge.second);
    graph.next[edge.second].push_back(edge.first);
  }
  return graph;
}

bool isCorner(const Graph& graph, const Points& vertices, int v) {
  const std::vector<int>& next = graph.next[v];
  if (next.size() != 2) return !next.empty();
  const Vec3 a = vertices[v] - vertices[next[0]], b = vertices[next[1]] - vertices[v];
  return dot(a, b) < std::cos(kTurn * kPi / 180) * norm(a) * norm(b);
}

}  // namespace

SharpEdges sharpEdges(const Mesh& surface, double angle) {
  const Graph graph = graphOf(surface, angle);
  SharpEdges sharp;
  std::vector<int> corner(surface.vertices.size(), -1);
  for (std::size_t v = 0; v < corner.size(); ++v)
    if (isCorner(graph, surface.vertices, static_cast<int>(v))) {
      corner[v] = static_cast<int>(sharp.corners.size());
      sharp.corners.push_back(surface.vertices[v]);
    }
  std::map<std::pair<int, int>, bool> used;
  const auto follow = [&](int start, int second) {
    SharpCurve curve;
    curve.corners[0] = corner[start];
    curve.points = {surface.vertices[start]};
    for (int before = start, at = second;;) {
      used[std::minmax(before, at)] = true;
      curve.length += norm(surface.vertices[at] - surface.vertices[before]);
      curve.points.push_back(surface.vertices[at]);
      curve.corners[1] = corner[at];
      if (corner[at] >= 0 || at == start) break;
      const std::vector<int>& next = graph.next[at];
      const int on = next[0] == before ? next[1] : next[0];
      before = at;
      at = on;
    }
    sharp.curves.push_back(std::move(curve));
  };
  // From the corners first; what is left are closed curves.
  for (const bool closed : {false, true})
    for (std::size_t v = 0; v < corner.size(); ++v)
      if ((corner[v] >= 0) != closed)
        for (const int w : graph.next[v])
          if (!used[std::minmax(static_cast<int>(v), w)]) follow(static_cast<int>(v), w);
  return sharp;
}

}  // namespace innermap
