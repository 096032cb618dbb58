// A map that is known, for the tests of what is made of maps.
#pragma once

#include "innermap/field/harmonic_field.h"

namespace innermap::test {

// p -> m p + shift.
inline HarmonicMap affineMap(const Mat3& m, const Vec3& shift) {
  Affine affine;
  affine.coefficients = Matrix(4, 3);
  for (int r = 0; r < 3; ++r) {
    affine.coefficients(0, r) = shift[r];
    for (int a = 0; a < 3; ++a) affine.coefficients(1 + a, r) = m[r][a];
  }
  return HarmonicMap(HarmonicField({}, Matrix(0, 3), affine));
}

}  // namespace innermap::test
