#include <algorithm>
#include <cmath>
#include <limits>

#include "core/pi.h"
#include "innermap/surface/correspond.h"

namespace innermap {
namespace {

// Solid angle of the cone over three unit vectors (Van Oosterom and Strackee 1983), or the area of
// the triangle in the plane z = 1.
double coveredArea(ModelSpace space, const Vec3& p, const Vec3& q, const Vec3& r) {
  const double det = tripleProduct(p, q, r);
  if (space == ModelSpace::torus) return 0.5 * det;
  return 2 * std::atan2(det, 1 + dot(p, q) + dot(q, r) + dot(r, p));
}

double spaceArea(const Layout& layout) {
  if (layout.space == ModelSpace::sphere) return 4 * kPi;
  return std::abs(cross(layout.period[0], layout.period[1]).z);
}

}  // namespace

LayoutQuality layoutQuality(const std::vector<Triangle>& triangles, const Points& vertices,
                            const Layout& layout) {
  LayoutQuality quality;
  const double total = surfaceArea(vertices, triangles);
  double covered = 0;
  const auto restArea = [&](const Triangle& t) {
    const Vec3& a = vertices[t[0]];
    return 0.5 * norm(cross(vertices[t[1]] - a, vertices[t[2]] - a));
  };
  const double space = spaceArea(layout);
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const int i = static_cast<int>(t);
    const Vec3 p = layout.corner(triangles, i, 0), q = layout.corner(triangles, i, 1),
               r = layout.corner(triangles, i, 2);
    if (!(tripleProduct(p, q, r) > 0)) ++quality.flips;
    const double area = coveredArea(layout.space, p, q, r);
    covered += area;
    const double rest = restArea(triangles[t]);
    // Slivers have no share worth comparing.
    if (rest > 1e-6 * total / static_cast<double>(triangles.size()))
      least = std::min(least, std::max(area, 0.0) * total / (space * rest));
  }
  quality.degree = covered / space;
  quality.areaRatioLog10 = std::log10(least);
  return quality;
}

LayoutQuality together(const std::vector<LayoutQuality>& shells) {
  LayoutQuality all;
  all.areaRatioLog10 = std::numeric_limits<double>::infinity();
  double farthest = -1;
  for (const LayoutQuality& q : shells) {
    all.flips += q.flips;
    all.areaRatioLog10 = std::min(all.areaRatioLog10, q.areaRatioLog10);
    if (std::abs(q.degree - 1) > farthest) {
      farthest = std::abs(q.degree - 1);
      all.degree = q.degree;
    }
  }
  return all;
}

}  // namespace innermap
