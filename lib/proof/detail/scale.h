// The proof's unit of length.
#pragma once

#include <cmath>

#include "innermap/core/vec3.h"

namespace innermap::proof {

// The least power of two above x.
inline double powerAbove(double x) {
  int exponent = 0;
  std::frexp(x, &exponent);
  return std::ldexp(1, exponent);
}

// Positions times this, a power of two, have a diagonal in [1/2, 1).
inline double proofScale(const Box3& box) { return 1 / powerAbove(box.diagonal()); }

}  // namespace innermap::proof
