// Distances along the edges of a closed surface.
#pragma once

#include <vector>

#include "innermap/surface/correspond.h"
#include "surface/detail/topology/half_edges.h"

namespace innermap {

// The surface must outlive it.
class EdgeDistance {
 public:
  explicit EdgeDistance(const ClosedSurface& surface)
      : surface_(surface),
        edges_(surface.triangles),
        outgoing_(edges_.outgoing(surface.vertices.size())) {}

  // Of each vertex from the nearest source (Dijkstra). With `reachedBy`, also the half-edge by
  // which the path to each vertex ends, -1 at sources.
  std::vector<double> operator()(const std::vector<int>& sources,
                                 std::vector<int>* reachedBy = nullptr) const;

 private:
  const ClosedSurface& surface_;
  HalfEdges edges_;
  std::vector<int> outgoing_;
};

}  // namespace innermap
