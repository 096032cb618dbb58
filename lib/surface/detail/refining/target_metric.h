// The shape of a surface over its layout, for maps onto it.
#pragma once

#include <vector>

#include "innermap/core/vec3.h"
#include "innermap/surface/correspond.h"
#include "surface/detail/refining/locate.h"

namespace innermap {

// How a linear map stretches: J's squared Frobenius norm and determinant.
struct Stretch {
  double squared = 0, det = 0;

  double symmetricDirichlet() const { return squared * (1 + 1 / (det * det)); }
  // Of the map and its inverse, as area elements of both surfaces weigh them.
  double bothWays() const { return symmetricDirichlet() * (1 + det); }
  // ln^2 s1 + ln^2 s2 of the singular values: 0 for isometries, alike for the inverse.
  double logSquared() const;
};

class TargetMetric {
 public:
  // The surface is scaled to unit area; slivers get some (rest_triangle.h). The layout is copied.
  TargetMetric(const ClosedSurface& surface, const Layout& layout);

  const Locator& locator() const { return locator_; }

  // The projection from rays onto the surface, at the weights in the triangle found: images of two
  // tangent vectors, in the triangle's plane.
  struct Plane {
    Vec2 e, f;
    double det() const { return e.x * f.y - e.y * f.x; }
  };
  Plane project(const Located& where, const Locator::Weights& w, const Vec3& e,
                const Vec3& f) const {
    const Locator::Cone& cone = locator_.cone(where.triangle);
    const double inverse = 1 / (w[0] + w[1] + w[2]);
    const double b1 = w[1] * inverse, b2 = w[2] * inverse;
    const Shape& s = shapes_[where.triangle];
    const auto image = [&](const Vec3& d) {
      const double d1 = dot(d, cone.side[1]), d2 = dot(d, cone.side[2]);
      const double all = dot(d, cone.side[0]) + d1 + d2;
      const double c1 = inverse * (d1 - b1 * all), c2 = inverse * (d2 - b2 * all);
      return Vec2{s.length * c1 + s.x * c2, s.y * c2};
    };
    return {image(e), image(f)};
  }

 private:
  // Corners at (0, 0), (length, 0), (x, y).
  struct Shape {
    double length, x, y;
  };
  double scale_ = 1;
  Locator locator_;
  std::vector<Shape> shapes_;
};

// Factor by which a surface's lengths must be multiplied so that its area is 1.
double unitAreaScale(const Points& vertices, const std::vector<Triangle>& triangles);

}  // namespace innermap
