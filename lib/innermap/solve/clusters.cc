#include "innermap/solve/clusters.h"

#include <algorithm>
#include <numeric>

namespace innermap {
namespace {

using Index = std::vector<std::size_t>::iterator;

void split(const Points& points, Index begin, Index end, std::size_t largest,
           std::vector<std::vector<std::size_t>>& out) {
  const std::size_t count = static_cast<std::size_t>(end - begin);
  if (count <= largest) {
    if (count == 0) return;
    out.emplace_back(begin, end);
    std::sort(out.back().begin(), out.back().end());
    return;
  }
  Box3 box;
  for (Index i = begin; i != end; ++i) box.add(points[*i]);
  const Vec3 side = box.extent();
  const int axis = side.x >= side.y && side.x >= side.z ? 0 : side.y >= side.z ? 1 : 2;
  const Index middle = begin + static_cast<std::ptrdiff_t>(count / 2);
  std::nth_element(begin, middle, end, [&](std::size_t a, std::size_t b) {
    const double x = points[a][axis], y = points[b][axis];
    return x < y || (x == y && a < b);
  });
  split(points, begin, middle, largest, out);
  split(points, middle, end, largest, out);
}

}  // namespace

std::vector<std::vector<std::size_t>> clusterPoints(const Points& points, std::size_t largest) {
  std::vector<std::size_t> order(points.size());
  std::iota(order.begin(), order.end(), 0);
  std::vector<std::vector<std::size_t>> out;
  split(points, order.begin(), order.end(), std::max<std::size_t>(1, largest), out);
  return out;
}

std::vector<std::size_t> pointsWithin(const Points& points, const Box3& box, double margin) {
  const Vec3 wide{margin, margin, margin}, lower = box.lower - wide, upper = box.upper + wide;
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3& p = points[i];
    if (p.x >= lower.x && p.x <= upper.x && p.y >= lower.y && p.y <= upper.y && p.z >= lower.z &&
        p.z <= upper.z)
      out.push_back(i);
  }
  return out;
}

}  // namespace innermap
