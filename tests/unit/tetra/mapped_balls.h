// Balls with maps, for the tests of meshes carried by them.
#pragma once

#include <cmath>

#include "fit/test_pairs.h"
#include "innermap/fit/fit_map.h"
#include "innermap/fit/mapped_solid.h"

namespace innermap::test {

// The map is affine, and known.
inline MappedSolid affineBall() {
  const Mesh source = ball(3);
  Affine affine;
  affine.coefficients = Matrix(4, 3);
  const Vec3 shift = affineMap({0, 0, 0});
  for (int r = 0; r < 3; ++r) {
    affine.coefficients(0, r) = shift[r];
    for (int a = 0; a < 3; ++a) {
      Vec3 unit;
      unit[a] = 1;
      affine.coefficients(1 + a, r) = affineMap(unit)[r] - shift[r];
    }
  }
  return {HarmonicMap(HarmonicField({}, Matrix(0, 3), affine)),
          makeBoundaryPair(source, moved(source, [](const Vec3& p) { return affineMap(p); })),
          {},
          {}};
}

}  // namespace innermap::test
