#include "io/picture/detail/place_colours.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "innermap/core/run.h"

namespace innermap {
namespace {

constexpr double kCells = 14;  // of the pattern, along the longest side of A's box

// pow(0.12 + 0.88 share, 1.8) within 2e-7: millions of points ask for it.
double brightness(double share) {
  constexpr std::size_t kParts = 1024;
  static const auto kTable = [] {
    std::array<double, kParts + 2> table;
    for (std::size_t i = 0; i < table.size(); ++i)
      table[i] = std::pow(0.12 + 0.88 * static_cast<double>(i) / kParts, 1.8);
    return table;
  }();
  const double at = kParts * share;
  const auto i = static_cast<std::size_t>(at);
  return kTable[i] + (at - static_cast<double>(i)) * (kTable[i + 1] - kTable[i]);
}

// A's box as colours, with a chequered pattern in which stretch can be seen.
Vec3 colourOf(const Vec3& p, const Box3& box) {
  const Vec3 extent = box.extent();
  const double longest = std::max({extent.x, extent.y, extent.z, 1e-300});
  Vec3 colour;
  int parity = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double along = p[axis] - box.lower[axis];
    const double share = std::clamp(along / std::max(extent[axis], 1e-300), 0.0, 1.0);
    colour[axis] = brightness(share);
    parity += static_cast<int>(std::floor(kCells * along / longest));
  }
  return (parity & 1 ? 0.72 : 1.0) * colour;
}

}  // namespace

std::vector<Vec3> placeColours(const Points& points, const Box3& box) {
  std::vector<Vec3> colours(points.size());
  parallelBlocks(points.size(), 4096, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) colours[i] = colourOf(points[i], box);
  });
  return colours;
}

std::vector<SurfacePoint> addresses(const std::vector<VisiblePoint>& seen) {
  std::vector<SurfacePoint> points(seen.size());
  parallelBlocks(points.size(), 4096, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) points[i] = {seen[i].triangle, seen[i].barycentric};
  });
  return points;
}

}  // namespace innermap
