// The symmetric Dirichlet energy of the triangles around one vertex of a layout.
#pragma once

#include <limits>
#include <vector>

#include "innermap/core/vec3.h"
#include "innermap/surface/correspond.h"

namespace innermap {

// One triangle of a star: the free vertex's corner, and the others at a and b.
struct StarTriangle {
  Vec3 a, b;
  double cotFree, cotA, cotB;  // halves, of the rest shape
  double fourAreaSquared;      // of the rest shape

  double dirichlet(const Vec3& q) const {
    return cotA * squaredNorm(q - b) + cotB * squaredNorm(q - a) + cotFree * squaredNorm(a - b);
  }
};

// Sum of area |J|^2 (1 + 1 / d^2) with the free vertex at q, d = tripleProduct over twice the rest
// area: exact in the plane (z = 1); on the sphere the determinant of unit vectors stands in the
// place of the chord's area. Infinite where a triangle is not positive.
inline double stretchEnergy(const std::vector<StarTriangle>& star, const Vec3& q) {
  double sum = 0;
  for (const StarTriangle& t : star) {
    const double det = tripleProduct(q, t.a, t.b);
    if (!(det > 0)) return std::numeric_limits<double>::infinity();
    sum += t.dirichlet(q) * (1 + t.fourAreaSquared / (det * det));
  }
  return sum;
}

}  // namespace innermap
