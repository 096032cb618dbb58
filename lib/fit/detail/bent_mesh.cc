#include "fit/detail/bent_mesh.h"

#include <algorithm>
#include <limits>

namespace innermap {
namespace {

// Lagrange's polynomial: 1 at place k of an edge, 0 at the others and at the ends.
double weight(std::size_t k, double along) {
  double w = along * (1 - along) / (kAlongEdge[k] * (1 - kAlongEdge[k]));
  for (std::size_t j = 0; j < kAlongEdge.size(); ++j)
    if (j != k) w *= (along - kAlongEdge[j]) / (kAlongEdge[k] - kAlongEdge[j]);
  return w;
}

}  // namespace

BentMesh::Place BentMesh::at(const SurfacePoint& onSurface) const {
  const SurfacePoint p = solid_.address(onSurface);
  const Mesh& mesh = solid_.repaired().mesh;
  const Triangle& corners = mesh.triangles[p.triangle];
  Place out{positionOf(mesh, p), 0};
  for (int e = 0; e < 3; ++e) {
    int from = e, to = (e + 1) % 3;
    if (corners[from] > corners[to]) std::swap(from, to);
    const auto found = edges_.find({corners[from], corners[to]});
    if (found == edges_.end()) return {out.position, std::numeric_limits<double>::infinity()};
    const Vec3 &a = mesh.vertices[corners[from]], &b = mesh.vertices[corners[to]];
    const double beside = p.barycentric[from] + p.barycentric[to];
    for (std::size_t k = 0; k < kAlongEdge.size(); ++k) {
      const Vec3 off = found->second[k] - (a + kAlongEdge[k] * (b - a));
      out.bent = std::max(out.bent, norm(off));
      if (beside > 0)
        out.position = out.position + beside * beside * weight(k, p.barycentric[to] / beside) * off;
    }
  }
  return out;
}

}  // namespace innermap
