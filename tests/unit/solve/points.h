// Random points for the tests of solve/ and field/.
#pragma once

#include <cmath>

#include "core/pi.h"
#include "core/random.h"
#include "innermap/core/matrix.h"
#include "innermap/core/vec3.h"

namespace innermap::testing {

// Uniform in the cube [-1, 1]^3.
inline Points randomPoints(std::size_t count, std::uint64_t seed) {
  const CounterRandom random(seed, 7);
  Points points(count);
  for (std::size_t i = 0; i < count; ++i)
    for (int a = 0; a < 3; ++a) points[i][a] = 2 * random.uniform(3 * i + a) - 1;
  return points;
}

// Uniform in [-1, 1], rows x columns.
inline Matrix randomWeights(std::size_t rows, std::size_t columns, std::uint64_t seed) {
  const CounterRandom random(seed, 3);
  Matrix w(rows, columns);
  for (std::size_t i = 0; i < rows * columns; ++i) w.data()[i] = 2 * random.uniform(i) - 1;
  return w;
}

// Fibonacci lattice on the sphere of the given radius about the origin.
inline Points spherePoints(std::size_t count, double radius, double turn = 0) {
  Points points(count);
  const double golden = kPi * (3 - std::sqrt(5.0));
  for (std::size_t i = 0; i < count; ++i) {
    const double z = 1 - (2 * i + 1.0) / count, r = std::sqrt(1 - z * z);
    const double angle = golden * i + turn;
    points[i] = radius * Vec3{r * std::cos(angle), r * std::sin(angle), z};
  }
  return points;
}

}  // namespace innermap::testing
