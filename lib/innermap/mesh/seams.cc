#include "innermap/mesh/seams.h"

#include "innermap/mesh/detail/topology.h"

namespace innermap {

std::vector<int> joinedVertices(const Points& vertices, const std::vector<Triangle>& triangles) {
  return joinSeams(vertices, triangles);
}

}  // namespace innermap
