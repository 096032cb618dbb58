// Sphere-like meshes on which no two places look alike.
#pragma once

#include <cmath>
#include <string>

#include "mesh/shapes.h"

namespace innermap::shapes {

// A ball with a large and a small bump, of other proportions.
inline Mesh blob(const std::string& name, int levels, double bump, Vec3 factors = {1, 1, 1}) {
  Mesh mesh = icosphere(levels);
  mesh.name = name;
  for (Vec3& p : mesh.vertices) {
    const double grown = 1 + bump * std::exp(4 * (p.x - 1)) + 0.5 * bump * std::exp(6 * (p.y - 1));
    p = grown * Vec3{factors.x * p.x, factors.y * p.y, factors.z * p.z};
  }
  return mesh;
}

// Without its first triangles.
inline Mesh opened(Mesh mesh, int triangles) {
  mesh.triangles.erase(mesh.triangles.begin(), mesh.triangles.begin() + triangles);
  return mesh;
}

// Two balls that overlap.
inline Mesh overlapping(const std::string& name) {
  Mesh mesh = joined(icosphere(2), icosphere(2, 1, {0.9, 0.2, 0}));
  mesh.name = name;
  return mesh;
}

}  // namespace innermap::shapes
