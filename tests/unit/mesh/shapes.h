// Meshes made for tests.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "core/pi.h"
#include "core/random.h"
#include "innermap/mesh/mesh.h"

namespace innermap::shapes {

// Regular icosahedron with each triangle cut in four `levels` times, vertices on the sphere.
inline Mesh icosphere(int levels, double radius = 1, Vec3 center = {}) {
  const double t = (1 + std::sqrt(5.0)) / 2;
  Mesh mesh;
  mesh.name = "icosphere";
  mesh.vertices = {{-1, t, 0},  {1, t, 0},  {-1, -t, 0}, {1, -t, 0}, {0, -1, t},  {0, 1, t},
                   {0, -1, -t}, {0, 1, -t}, {t, 0, -1},  {t, 0, 1},  {-t, 0, -1}, {-t, 0, 1}};
  mesh.triangles = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                    {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                    {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                    {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<int, int>, int> middles;
    const auto middle = [&](int a, int b) {
      const auto [found, isNew] = middles.try_emplace(std::minmax(a, b), 0);
      if (isNew) {
        found->second = static_cast<int>(mesh.vertices.size());
        mesh.vertices.push_back(0.5 * (mesh.vertices[a] + mesh.vertices[b]));
      }
      return found->second;
    };
    std::vector<Triangle> finer;
    for (const auto& [a, b, c] : mesh.triangles) {
      const int ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    mesh.triangles = std::move(finer);
    for (Vec3& v : mesh.vertices) v = v / norm(v);
  }
  for (Vec3& v : mesh.vertices) v = center + (radius / norm(v)) * v;
  return mesh;
}

// Torus about the z axis with n segments around the axis and m around the tube.
inline Mesh torus(int n, int m, double major = 1, double minor = 0.35) {
  Mesh mesh;
  mesh.name = "torus";
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < m; ++j) {
      const double u = 2 * kPi * i / n, v = 2 * kPi * j / m;
      const double r = major + minor * std::cos(v);
      mesh.vertices.push_back({r * std::cos(u), r * std::sin(u), minor * std::sin(v)});
      const int a = i * m + j, b = (i + 1) % n * m + j;
      const int c = (i + 1) % n * m + (j + 1) % m, d = i * m + (j + 1) % m;
      mesh.triangles.push_back({a, b, c});
      mesh.triangles.push_back({a, c, d});
    }
  }
  return mesh;
}

// A rod bent along a circle by `angle`: beyond a full turn its ends run into one another. The
// middle of the rod is at (0, -2, 0).
inline Mesh coil(double angle, double radius = 2, double thickness = 0.5) {
  Mesh mesh = icosphere(4);
  for (Vec3& p : mesh.vertices) {
    const double along = 0.5 * angle * p.x, out = radius + thickness * p.y;
    p = {out * std::sin(along), -out * std::cos(along), thickness * p.z};
  }
  return mesh;
}

inline Mesh box(Vec3 lower, Vec3 upper) {
  Mesh mesh;
  mesh.name = "box";
  for (int i = 0; i < 8; ++i) {
    mesh.vertices.push_back(
        {i & 1 ? upper.x : lower.x, i & 2 ? upper.y : lower.y, i & 4 ? upper.z : lower.z});
  }
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

inline Mesh joined(const Mesh& a, const Mesh& b) {
  Mesh mesh;
  mesh.name = a.name + " and " + b.name;
  mesh.vertices = a.vertices;
  mesh.triangles = a.triangles;
  const int offset = static_cast<int>(a.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), b.vertices.begin(), b.vertices.end());
  for (const auto& [i, j, k] : b.triangles)
    mesh.triangles.push_back({i + offset, j + offset, k + offset});
  return mesh;
}

inline Mesh transformed(Mesh mesh, double scale, Vec3 shift) {
  for (Vec3& v : mesh.vertices) v = shift + scale * v;
  return mesh;
}

inline Mesh flipped(Mesh mesh) {
  for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
  return mesh;
}

// Uniform in the cube [-1, 1]^3.
inline Vec3 randomPoint(const CounterRandom& random, std::uint64_t i) {
  return {2 * random.uniform(3 * i) - 1, 2 * random.uniform(3 * i + 1) - 1,
          2 * random.uniform(3 * i + 2) - 1};
}

// Independent triangles of edge lengths about `size` in the cube [-1, 1]^3.
inline Mesh soup(int count, double size, std::uint64_t seed) {
  const CounterRandom random(seed, 77);
  Mesh mesh;
  mesh.name = "soup";
  for (int t = 0; t < count; ++t) {
    const Vec3 place = randomPoint(random, 4 * t);
    for (int k = 1; k <= 3; ++k)
      mesh.vertices.push_back(place + size * randomPoint(random, 4 * t + k));
    mesh.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
  }
  return mesh;
}

inline double leastDistance(const Points& points) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < points.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) least = std::min(least, norm(points[i] - points[j]));
  return least;
}

}  // namespace innermap::shapes
