#include "solve/detail/clusters.h"

#include <algorithm>
#include <numeric>

namespace innermap {
namespace {

using Index = std::vector<std::size_t>::iterator;

struct Splitting {
  const Points& points;
  std::size_t largest;
  double widest;
  std::vector<std::vector<std::size_t>> clusters;

  void split(Index begin, Index end) {
    const std::size_t count = static_cast<std::size_t>(end - begin);
    if (count == 0) return;
    Box3 box;
    for (Index i = begin; i != end; ++i) box.add(points[*i]);
    const Vec3 side = box.extent();
    const int axis = side.x >= side.y && side.x >= side.z ? 0 : side.y >= side.z ? 1 : 2;
    if (count <= largest && !(side[axis] > widest)) {
      clusters.emplace_back(begin, end);
      std::sort(clusters.back().begin(), clusters.back().end());
      return;
    }
    Index middle = count > largest ? begin : atMiddle(begin, end, axis, box);
    if (middle == begin) middle = atMedian(begin, end, axis);
    split(begin, middle);
    split(middle, end);
  }

  Index atMedian(Index begin, Index end, int axis) const {
    const Index middle = begin + (end - begin) / 2;
    std::nth_element(begin, middle, end, [&](std::size_t a, std::size_t b) {
      const double x = points[a][axis], y = points[b][axis];
      return x < y || (x == y && a < b);
    });
    return middle;
  }

  Index atMiddle(Index begin, Index end, int axis, const Box3& box) const {
    const double at = box.center()[axis];
    return std::partition(begin, end, [&](std::size_t i) { return points[i][axis] < at; });
  }
};

}  // namespace

std::vector<std::vector<std::size_t>> clusterPoints(const Points& points, std::size_t largest,
                                                    double widest) {
  std::vector<std::size_t> order(points.size());
  std::iota(order.begin(), order.end(), 0);
  Splitting splitting{points, std::max<std::size_t>(1, largest), widest, {}};
  splitting.split(order.begin(), order.end());
  return std::move(splitting.clusters);
}

}  // namespace innermap
