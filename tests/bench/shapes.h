// Inputs of the benchmarks: made here, of fixed sizes, so that figures can be compared over time.
#pragma once

#include <cmath>

#include "core/pi.h"
#include "core/random.h"
#include "innermap/core/matrix.h"
#include "innermap/core/vec3.h"
#include "innermap/mesh/mesh.h"

namespace innermap::bench {

// Of the matrices that are factorized.
constexpr std::size_t kRows = 2400, kColumns = 800;

inline Points randomPoints(std::size_t count, std::uint64_t seed) {
  const CounterRandom random(seed, 1);
  Points points(count);
  for (std::size_t i = 0; i < count; ++i)
    for (int a = 0; a < 3; ++a) points[i][a] = random.uniform(3 * i + a);
  return points;
}

inline Matrix randomMatrix(std::size_t rows, std::size_t columns, std::uint64_t seed) {
  const CounterRandom random(seed, 2);
  Matrix m(rows, columns);
  for (std::size_t i = 0; i < rows * columns; ++i) m.data()[i] = random.uniform(i) - 0.5;
  return m;
}

// A wavy torus of 2 n^2 triangles: smooth, not convex, nothing aligned with the axes.
inline Mesh wavyTorus(int n) {
  Mesh mesh;
  mesh.name = "wavy torus";
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const double u = 2 * kPi * i / n, v = 2 * kPi * j / n;
      const double minor = 0.35 + 0.05 * std::sin(5 * u) * std::cos(3 * v);
      const double r = 1 + minor * std::cos(v);
      mesh.vertices.push_back(
          {r * std::cos(u), r * std::sin(u), minor * std::sin(v) + 0.3 * std::cos(2 * u)});
      const int a = i * n + j, b = (i + 1) % n * n + j, c = (i + 1) % n * n + (j + 1) % n,
                d = i * n + (j + 1) % n;
      mesh.triangles.push_back({a, b, c});
      mesh.triangles.push_back({a, c, d});
    }
  return mesh;
}

}  // namespace innermap::bench
