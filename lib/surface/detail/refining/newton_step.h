// A minimiser's step in two unknowns.
#pragma once

#include <algorithm>
#include <cmath>

#include "innermap/core/vec3.h"

namespace innermap {

// Newton's step for the gradient and Hessian given, with the Hessian's eigenvalues made positive
// (their absolute values), so that it leads downhill.
inline Vec2 newtonStep(double gu, double gv, double huu, double huv, double hvv) {
  const double mean = 0.5 * (huu + hvv), half = 0.5 * (huu - hvv);
  const double spread = std::sqrt(half * half + huv * huv);
  const double floor = 1e-9 * (std::abs(mean) + spread) + 1e-300;
  const double first = std::max(std::abs(mean + spread), floor),
               second = std::max(std::abs(mean - spread), floor);
  const double angle = 0.5 * std::atan2(huv, half);  // of the eigenvector of mean + spread
  const double c = std::cos(angle), s = std::sin(angle);
  const double a = -(c * gu + s * gv) / first, b = -(c * gv - s * gu) / second;
  return {c * a - s * b, s * a + c * b};
}

}  // namespace innermap
