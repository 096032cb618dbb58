// Affine functions of position: the harmonic part that a sum of charges is bad at.
#pragma once

#include "innermap/core/matrix.h"
#include "innermap/core/vec3.h"

namespace innermap {

// value_k(p) = c(0, k) + c(1, k) (p - center).x + c(2, k) (p - center).y + c(3, k) (p - center).z
struct Affine {
  Vec3 center;
  Matrix coefficients;  // 4 x #K

  double value(const Vec3& p, std::size_t channel) const {
    const Vec3 d = p - center;
    return coefficients(0, channel) + coefficients(1, channel) * d.x +
           coefficients(2, channel) * d.y + coefficients(3, channel) * d.z;
  }
};

}  // namespace innermap
