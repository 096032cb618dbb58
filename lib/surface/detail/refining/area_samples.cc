#include "surface/detail/refining/area_samples.h"

#include <algorithm>
#include <numeric>

namespace innermap {
namespace {

// The i-th point of a sequence that fills the triangle evenly, the middle first.
std::array<double, 3> spread(std::size_t i) {
  constexpr double kStepX = 0.7548776662466927, kStepY = 0.5698402909980532;
  const double n = static_cast<double>(i);
  double x = 1.0 / 3 + n * kStepX, y = 1.0 / 3 + n * kStepY;
  x -= std::floor(x);
  y -= std::floor(y);
  if (x + y > 1) {
    x = 1 - x;
    y = 1 - y;
  }
  return {1 - x - y, x, y};
}

}  // namespace

std::vector<double> triangleAreas(const Points& vertices, const std::vector<Triangle>& triangles) {
  std::vector<double> areas;
  areas.reserve(triangles.size());
  for (const auto& [a, b, c] : triangles)
    areas.push_back(0.5 * norm(cross(vertices[b] - vertices[a], vertices[c] - vertices[a])));
  return areas;
}

std::vector<AreaSample> areaSamples(const ClosedSurface& surface, const std::vector<double>& shares,
                                    double count) {
  const double total = std::accumulate(shares.begin(), shares.end(), 0.0);
  const std::vector<double> areas = triangleAreas(surface.vertices, surface.triangles);
  std::vector<AreaSample> samples;
  samples.reserve(static_cast<std::size_t>(count) + areas.size());
  for (std::size_t t = 0; t < areas.size(); ++t) {
    const double wanted = total > 0 ? std::ceil(count * shares[t] / total) : 1;
    const std::size_t n = static_cast<std::size_t>(std::max(1.0, wanted));
    for (std::size_t i = 0; i < n; ++i)
      samples.push_back({static_cast<int>(t), areas[t] / static_cast<double>(n), spread(i)});
  }
  return samples;
}

}  // namespace innermap
