// Real spherical harmonics of colours, turned.
#pragma once

#include "innermap/core/vec3.h"

namespace innermap {

constexpr int kHarmonicDegrees = 3;

// Harmonics of degrees 1 to 3 turned by an orthogonal matrix, reflections included.
class HarmonicTurn {
 public:
  // degree: 0 to 3, the highest that is turned.
  HarmonicTurn(const Mat3& orthogonal, int degree);

  // coefficients: of one colour, (degree + 1)^2 - 1, as transfer/geometry.h has them. Afterwards
  // they say along R d what they said along d.
  void turn(double* coefficients) const;

 private:
  int degree_;
  double matrices_[3 * 3 + 5 * 5 + 7 * 7];  // row by row, one degree after the other
};

// The harmonics of that degree (1 to 3) at a direction, 2 degree + 1; of a vector of another length
// times its power.
void evaluateHarmonics(int degree, const Vec3& d, double* out);

}  // namespace innermap
