#include "innermap/surface/detail/topology/half_edges.h"

#include <algorithm>
#include <array>

#include "innermap/core/error.h"

namespace innermap {

HalfEdges::HalfEdges(const std::vector<Triangle>& triangles)
    : triangles_(&triangles), opposite_(3 * triangles.size(), -1) {
  std::vector<std::array<int, 3>> sides;  // low vertex, high vertex, half-edge
  sides.reserve(opposite_.size());
  for (int h = 0; h < size(); ++h)
    sides.push_back({std::min(tail(h), head(h)), std::max(tail(h), head(h)), h});
  std::sort(sides.begin(), sides.end());
  for (std::size_t i = 0; i < sides.size(); i += 2) {
    const auto same = [&](std::size_t j) {
      return j < sides.size() && sides[j][0] == sides[i][0] && sides[j][1] == sides[i][1];
    };
    if (!same(i + 1) || same(i + 2) || tail(sides[i][2]) != head(sides[i + 1][2]))
      throw DataError("an edge of the surface does not have two triangles, one running each way");
    opposite_[sides[i][2]] = sides[i + 1][2];
    opposite_[sides[i + 1][2]] = sides[i][2];
  }
}

std::vector<int> HalfEdges::outgoing(std::size_t vertices) const {
  std::vector<int> out(vertices, -1);
  for (int h = size() - 1; h >= 0; --h) out[tail(h)] = h;
  return out;
}

}  // namespace innermap
