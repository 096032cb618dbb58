// Lattices of cubes, cut in six tetrahedra each.
#pragma once

#include <array>
#include <functional>
#include <map>

#include "innermap/lattice/cell_mesh.h"

namespace innermap::test {

// The vertex of a box of n cubes a side, numbered with z fastest.
inline int latticeVertex(int n, int x, int y, int z) { return (x * (n + 1) + y) * (n + 1) + z; }

// Kuhn's cut of those cubes of the box [0, 1]^3, n a side, of which `inside` is true at the centre.
inline CellMesh kuhnMesh(int n, const std::function<bool(const Vec3&)>& inside = {}) {
  constexpr std::array<std::array<int, 4>, 6> kTets{
      {{0, 1, 3, 7}, {0, 3, 2, 7}, {0, 2, 6, 7}, {0, 6, 4, 7}, {0, 4, 5, 7}, {0, 5, 1, 7}}};
  CellMesh mesh;
  mesh.name = "lattice";
  const double h = 1.0 / n;
  std::map<std::array<int, 3>, int> numbers;
  const auto number = [&](int x, int y, int z) {
    const auto [at, fresh] = numbers.try_emplace({x, y, z}, static_cast<int>(numbers.size()));
    if (fresh) mesh.vertices.push_back({h * x, h * y, h * z});
    return at->second;
  };
  for (int x = 0; x < n; ++x)
    for (int y = 0; y < n; ++y)
      for (int z = 0; z < n; ++z) {
        if (inside && !inside({h * (x + 0.5), h * (y + 0.5), h * (z + 0.5)})) continue;
        for (const auto& t : kTets) {
          Tetrahedron tet{};
          for (std::size_t i = 0; i < 4; ++i)
            tet[i] = number(x + (t[i] & 1), y + (t[i] >> 1 & 1), z + (t[i] >> 2 & 1));
          mesh.tetrahedra.push_back(tet);
        }
      }
  return mesh;
}

// The same as hexahedra.
inline CellMesh cubeMesh(int n) {
  CellMesh mesh;
  mesh.name = "cubes";
  const double h = 1.0 / n;
  for (int x = 0; x <= n; ++x)
    for (int y = 0; y <= n; ++y)
      for (int z = 0; z <= n; ++z) mesh.vertices.push_back({h * x, h * y, h * z});
  const auto at = [n](int x, int y, int z) { return latticeVertex(n, x, y, z); };
  for (int x = 0; x < n; ++x)
    for (int y = 0; y < n; ++y)
      for (int z = 0; z < n; ++z)
        mesh.hexahedra.push_back({at(x, y, z), at(x + 1, y, z), at(x + 1, y + 1, z),
                                  at(x, y + 1, z), at(x, y, z + 1), at(x + 1, y, z + 1),
                                  at(x + 1, y + 1, z + 1), at(x, y + 1, z + 1)});
  return mesh;
}

// Its boundary as a surface.
inline Mesh surfaceOf(const CellMesh& cells) {
  Mesh mesh;
  mesh.vertices = cells.vertices;
  mesh.triangles = boundaryTriangles(cells);
  return mesh;
}

}  // namespace innermap::test
