// More meshes, and files, for the tests of mesh/.
#pragma once

#include <array>
#include <map>

#include "core/temporary_folder.h"
#include "innermap/mesh/mesh.h"
#include "mesh/shapes.h"

namespace innermap::testing {

using test::TemporaryFolder;

inline Mesh makeMesh(Points vertices, std::vector<Triangle> triangles) {
  Mesh mesh;
  mesh.name = "test";
  mesh.vertices = std::move(vertices);
  mesh.triangles = std::move(triangles);
  return mesh;
}

// Outward, volume size^3.
inline Mesh cube(double size = 1, const Vec3& corner = {}) {
  return shapes::box(corner, corner + Vec3{size, size, size});
}

// Every triangle with vertices of its own.
inline Mesh exploded(const Mesh& mesh) {
  Mesh result;
  result.name = mesh.name;
  for (const Triangle& t : mesh.triangles) {
    const int first = static_cast<int>(result.vertices.size());
    for (const int v : t) result.vertices.push_back(mesh.vertices[v]);
    result.triangles.push_back({first, first + 1, first + 2});
  }
  return result;
}

// Net number of triangles along each edge, positions (not indices) being what counts: empty for a
// mesh whose winding numbers are whole.
inline std::map<std::array<double, 6>, int> unbalancedEdges(const Mesh& mesh) {
  std::map<std::array<double, 6>, int> net;
  for (const Triangle& t : mesh.triangles)
    for (int c = 0; c < 3; ++c) {
      const Vec3 &a = mesh.vertices[t[c]], &b = mesh.vertices[t[(c + 1) % 3]];
      const bool forward = std::array{a.x, a.y, a.z} < std::array{b.x, b.y, b.z};
      const Vec3 &p = forward ? a : b, &q = forward ? b : a;
      net[{p.x, p.y, p.z, q.x, q.y, q.z}] += forward ? 1 : -1;
    }
  for (auto it = net.begin(); it != net.end();)
    it = it->second == 0 ? net.erase(it) : std::next(it);
  return net;
}

}  // namespace innermap::testing
