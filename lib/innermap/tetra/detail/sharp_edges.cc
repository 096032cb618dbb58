#include "innermap/tetra/detail/sharp_edges.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace innermap {

SharpEdges sharpEdges(const Mesh& surface, double angle) {
  struct Side {
    int low, high, triangle;
  };
  std::vector<Side> sides;
  for (std::size_t t = 0; t < surface.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      const int a = surface.triangles[t][k], b = surface.triangles[t][(k + 1) % 3];
      sides.push_back({std::min(a, b), std::max(a, b), static_cast<int>(t)});
    }
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    return std::tie(a.low, a.high, a.triangle) < std::tie(b.low, b.high, b.triangle);
  });
  SharpEdges out;
  for (std::size_t i = 0; i + 1 < sides.size(); ++i) {
    const Side &a = sides[i], &b = sides[i + 1];
    if (a.low != b.low || a.high != b.high) continue;
    const Vec3 m = areaVector(surface, a.triangle), n = areaVector(surface, b.triangle);
    const double lengths = norm(m) * norm(n);
    if (!(lengths > 0) || dot(m, n) >= std::cos(angle) * lengths) continue;
    out.edges.push_back({a.low, a.high});
    out.length += norm(surface.vertices[a.high] - surface.vertices[a.low]);
  }
  return out;
}

Points samplesOf(const Mesh& surface, const SharpEdges& sharp, std::size_t count) {
  Points out;
  for (const auto& [a, b] : sharp.edges) {
    const Vec3 from = surface.vertices[a], way = surface.vertices[b] - from;
    const double share = norm(way) / sharp.length * static_cast<double>(count);
    const int pieces = std::max(1, static_cast<int>(std::ceil(share)));
    for (int i = 0; i < pieces; ++i) out.push_back(from + (i + 0.5) / pieces * way);
  }
  return out;
}

}  // namespace innermap
