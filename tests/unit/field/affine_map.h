// Maps that are known, for the tests of what is made of maps.
#pragma once

#include <cmath>

#include "innermap/field/harmonic_field.h"

namespace innermap::test {

inline constexpr Mat3 kIdentity = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};

// p -> m p + shift.
inline Affine affineOf(const Mat3& m, const Vec3& shift = {}) {
  Affine affine{{}, Matrix(4, 3)};
  for (int r = 0; r < 3; ++r) {
    affine.coefficients(0, r) = shift[r];
    for (int a = 0; a < 3; ++a) affine.coefficients(1 + a, r) = m[r][a];
  }
  return affine;
}

inline HarmonicMap affineMap(const Mat3& m, const Vec3& shift = {}) {
  return HarmonicMap(HarmonicField({}, Matrix(0, 3), affineOf(m, shift)));
}

// Identity and three charges outside the cube [-1, 1]^3: one-to-one there, no part of it affine.
inline HarmonicMap chargedMap(double strength = 0.3) {
  Matrix weights(3, 3);
  for (int i = 0; i < 9; ++i) weights.data()[i] = strength * std::sin(i + 1.0);
  return HarmonicMap(HarmonicField({{2.4, 0.3, 0}, {-0.2, 2.6, 0.4}, {0.3, 0.2, -2.5}}, weights,
                                   affineOf(kIdentity)));
}

}  // namespace innermap::test
