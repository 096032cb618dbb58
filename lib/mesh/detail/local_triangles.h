// Triangles as the searches among them want them.
#pragma once

#include <vector>

#include "core/bvh.h"
#include "innermap/mesh/mesh.h"

namespace innermap {

// Triangles in a local frame and the hierarchy of their boxes, those with non-finite corners left
// out. Immutable: what searches among the same triangles shares one.
struct LocalTriangles {
  struct Corners {
    Vec3 a, b, c;
  };
  LocalFrame frame;
  Bvh bvh;  // its order is used up: the others stand in the order of its leaves
  std::vector<Corners> corners;
  std::vector<int> index;  // into the triangles given
  std::vector<Box3> boxes;
  std::size_t given = 0;  // triangles, those that are left out too

  LocalTriangles(const Points& vertices, const std::vector<Triangle>& triangles);
};

}  // namespace innermap
