// A triangle's own shape, which a map stretches.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "innermap/core/vec3.h"

namespace innermap {

struct RestTriangle {
  double area = 0;
  std::array<double, 3> halfCot{};  // half the cotangent of the angle at each corner

  // Of three edge lengths, l[k] opposite corner k, all lengthened so that none of the triangle
  // inequalities is closer than `slack` (units of length; Sharp and Crane, "A Laplacian for
  // nonmanifold triangle meshes", 2020): slivers get some area, so that no energy is infinite.
  static RestTriangle ofLengths(std::array<double, 3> l, double slack) {
    const double least = std::min({l[0] + l[1] - l[2], l[1] + l[2] - l[0], l[2] + l[0] - l[1]});
    const double more = std::max(0.0, slack - least);
    for (double& x : l) x += more;
    const double s = 0.5 * (l[0] + l[1] + l[2]);
    RestTriangle out;
    out.area = std::sqrt(std::max(s * (s - l[0]) * (s - l[1]) * (s - l[2]), 1e-300));
    for (int k = 0; k < 3; ++k) {
      const double a = l[(k + 1) % 3], b = l[(k + 2) % 3];
      out.halfCot[k] = (a * a + b * b - l[k] * l[k]) / (8 * out.area);
    }
    return out;
  }
  static RestTriangle of(const Vec3& a, const Vec3& b, const Vec3& c, double slack) {
    return ofLengths({norm(c - b), norm(a - c), norm(b - a)}, slack);
  }
};

}  // namespace innermap
