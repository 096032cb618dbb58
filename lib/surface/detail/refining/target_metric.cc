#include "surface/detail/refining/target_metric.h"

#include <algorithm>
#include <cmath>

#include "surface/detail/refining/rest_triangle.h"

namespace innermap {

double Stretch::logSquared() const {
  if (!(det > 0)) return 1e6;
  const double area = std::log(det), shape = std::acosh(std::max(1.0, 0.5 * squared / det));
  return 0.5 * (area * area + shape * shape);
}

double unitAreaScale(const Points& vertices, const std::vector<Triangle>& triangles) {
  return 1 / std::sqrt(surfaceArea(vertices, triangles));
}

TargetMetric::TargetMetric(const ClosedSurface& surface, const Layout& layout)
    : scale_(unitAreaScale(surface.vertices, surface.triangles)),
      locator_(surface.triangles, layout) {
  const double mean = 1.5 / std::sqrt(static_cast<double>(surface.triangles.size()));
  const double slack = 0.02 * mean;
  shapes_.reserve(surface.triangles.size());
  for (const Triangle& t : surface.triangles) {
    const Vec3 &a = surface.vertices[t[0]], &b = surface.vertices[t[1]],
               &c = surface.vertices[t[2]];
    const RestTriangle r = RestTriangle::of(scale_ * a, scale_ * b, scale_ * c, slack);
    // From area and cotangents back to a place in the plane.
    const double base = std::sqrt(2 * r.area * 2 * (r.halfCot[0] + r.halfCot[1]));
    const double height = 2 * r.area / base;
    shapes_.push_back({base, 2 * r.halfCot[0] * height, height});
  }
}

}  // namespace innermap
