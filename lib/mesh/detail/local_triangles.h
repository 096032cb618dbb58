// Triangles as the searches among them want them.
#pragma once

#include <vector>

#include "core/bvh.h"
#include "innermap/mesh/mesh.h"

namespace innermap {

// Triangles in a local frame, those with non-finite corners left out.
struct LocalTriangles {
  struct Corners {
    Vec3 a, b, c;
  };
  LocalFrame frame;
  std::vector<Corners> corners;
  std::vector<int> index;  // into the triangles given
  std::vector<Box3> boxes;

  LocalTriangles(const Points& vertices, const std::vector<Triangle>& triangles);
};

}  // namespace innermap
