// Triangles as the searches among them want them.
#pragma once

#include <vector>

#include "core/bvh.h"
#include "innermap/mesh/mesh.h"

namespace innermap {

// Triangles in a local frame and the hierarchy of their boxes. Those with non-finite corners are
// left out. Searches among the same triangles share one.
struct LocalTriangles {
  struct Corners {
    Vec3 a, b, c;
  };
  LocalFrame frame;
  Bvh bvh;  // without its order: all below stand in the order of its leaves
  std::vector<Corners> corners;
  std::vector<int> index;  // into the triangles given
  std::vector<Box3> boxes;
  std::size_t given = 0;  // triangles, with those left out

  LocalTriangles(const Points& vertices, const std::vector<Triangle>& triangles);
};

}  // namespace innermap
