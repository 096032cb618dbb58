#include "surface/detail/topology/half_edges.h"

#include <algorithm>

#include "innermap/core/error.h"
#include "mesh/connectivity.h"

namespace innermap {

HalfEdges::HalfEdges(const std::vector<Triangle>& triangles)
    : triangles_(&triangles), opposite_(3 * triangles.size(), -1) {
  bool closed = std::none_of(triangles.begin(), triangles.end(), hasRepeatedVertex);
  forEachEdge(sortedEdges(triangles), [&](const EdgeUse* begin, const EdgeUse* end) {
    closed = closed && end - begin == 2 && begin[0].forward != begin[1].forward;
    if (!closed) return;
    opposite_[begin[0].side()] = begin[1].side();
    opposite_[begin[1].side()] = begin[0].side();
  });
  if (!closed)
    throw DataError("an edge of the surface does not have two triangles, one running each way");
}

std::vector<int> HalfEdges::outgoing(std::size_t vertices) const {
  std::vector<int> out(vertices, -1);
  for (int h = size() - 1; h >= 0; --h) out[tail(h)] = h;
  return out;
}

}  // namespace innermap
