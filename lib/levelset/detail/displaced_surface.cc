#include "levelset/detail/displaced_surface.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <unordered_map>

#include "innermap/core/run.h"

namespace innermap {
namespace {

// Vertices at the same place share a normal, or the surface would open along seams of pieces.
std::vector<int> weldedIndices(const Points& points) {
  std::vector<int> order(points.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<int>(i);
  const auto key = [&](int i) {
    return std::array<double, 3>{points[i].x, points[i].y, points[i].z};
  };
  std::sort(order.begin(), order.end(),
            [&](int i, int j) { return key(i) < key(j) || (key(i) == key(j) && i < j); });
  std::vector<int> welded(points.size());
  for (std::size_t k = 0; k < order.size(); ++k) {
    const bool same = k > 0 && key(order[k]) == key(order[k - 1]);
    welded[order[k]] = same ? welded[order[k - 1]] : order[k];
  }
  return welded;
}

double angleBetween(const Vec3& u, const Vec3& v) {
  return std::atan2(norm(cross(u, v)), dot(u, v));
}

// Area-free vertex normals: face normals weighted by the angle at the vertex, the only ones that
// do not depend on how a face is cut into triangles.
Points vertexNormals(const Points& vertices, const std::vector<Triangle>& triangles,
                     const std::vector<int>& welded) {
  Points normals(vertices.size());
  for (const Triangle& t : triangles) {
    const Vec3 n = cross(vertices[t[1]] - vertices[t[0]], vertices[t[2]] - vertices[t[0]]);
    const double size = norm(n);
    if (!(size > 0)) continue;
    for (int k = 0; k < 3; ++k) {
      const Vec3& a = vertices[t[k]];
      const double angle = angleBetween(vertices[t[(k + 1) % 3]] - a, vertices[t[(k + 2) % 3]] - a);
      normals[welded[t[k]]] += (angle / size) * n;
    }
  }
  for (std::size_t v = 0; v < normals.size(); ++v) {
    normals[v] = normals[welded[v]];
    const double size = norm(normals[v]);
    if (size > 0) normals[v] = normals[v] / size;
  }
  return normals;
}

// One pass: all edges longer than `edge` are halved, triangles follow. Edges are halved alike on
// both sides, so the surface stays closed.
bool halveLongEdges(Points& vertices, std::vector<Triangle>& triangles, double edge) {
  std::unordered_map<std::uint64_t, int> middles;
  const auto middle = [&](int a, int b) {
    const Vec3 d = vertices[b] - vertices[a];
    if (squaredNorm(d) <= edge * edge) return -1;
    const auto [lower, upper] = std::minmax(a, b);
    const auto key = static_cast<std::uint64_t>(lower) << 32 | static_cast<std::uint32_t>(upper);
    const auto [found, isNew] = middles.try_emplace(key, static_cast<int>(vertices.size()));
    if (isNew) vertices.push_back(0.5 * (vertices[a] + vertices[b]));
    return found->second;
  };
  std::vector<Triangle> finer;
  finer.reserve(triangles.size());
  for (const Triangle& t : triangles) {
    const int m[3] = {middle(t[0], t[1]), middle(t[1], t[2]), middle(t[2], t[0])};
    const int halved = (m[0] >= 0) + (m[1] >= 0) + (m[2] >= 0);
    if (halved == 0) {
      finer.push_back(t);
    } else if (halved == 3) {
      finer.insert(
          finer.end(),
          {{t[0], m[0], m[2]}, {m[0], t[1], m[1]}, {m[2], m[1], t[2]}, {m[0], m[1], m[2]}});
    } else if (halved == 1) {
      const int k = m[0] >= 0 ? 0 : m[1] >= 0 ? 1 : 2;
      const int a = t[k], b = t[(k + 1) % 3], c = t[(k + 2) % 3];
      finer.insert(finer.end(), {{a, m[k], c}, {m[k], b, c}});
    } else {
      // The corner between the two halved edges is cut off; the rest is two triangles.
      const int k = m[0] < 0 ? 1 : m[1] < 0 ? 2 : 0;  // first of the two halved edges
      const int a = t[k], b = t[(k + 1) % 3], c = t[(k + 2) % 3];
      const int p = m[k], q = m[(k + 1) % 3];
      finer.insert(finer.end(), {{p, b, q}, {a, p, q}, {a, q, c}});
    }
  }
  triangles = std::move(finer);
  return !middles.empty();
}

}  // namespace

Mesh displacedSurface(const Solid& solid, double distance, double edge) {
  const Mesh& surface = solid.surface();
  Mesh mesh;
  mesh.vertices = surface.vertices;
  const std::vector<int> welded = weldedIndices(mesh.vertices);
  // Edges between welded vertices are halved alike on both sides.
  for (const Triangle& t : surface.triangles) {
    mesh.triangles.push_back({welded[t[0]], welded[t[1]], welded[t[2]]});
  }
  for (int pass = 0; pass < 32; ++pass) {
    throwIfCancelled();
    if (!halveLongEdges(mesh.vertices, mesh.triangles, edge)) break;
  }
  std::vector<int> own(mesh.vertices.size());
  for (std::size_t v = 0; v < own.size(); ++v) own[v] = static_cast<int>(v);
  const Points normals = vertexNormals(mesh.vertices, mesh.triangles, own);
  for (std::size_t v = 0; v < normals.size(); ++v) mesh.vertices[v] += distance * normals[v];
  return mesh;
}

}  // namespace innermap
