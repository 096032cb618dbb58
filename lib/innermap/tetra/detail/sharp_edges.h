// Edges of a surface at which its faces meet at an angle.
#pragma once

#include <array>
#include <vector>

#include "innermap/mesh/mesh.h"

namespace innermap {

struct SharpEdges {
  std::vector<std::array<int, 2>> edges;
  double length = 0;  // of all
};

// Edges whose two triangles' normals differ by more than `angle`, in radians. Triangles without
// area have no normal and make no edge sharp.
SharpEdges sharpEdges(const Mesh& surface, double angle);

// At equal distances along them, about `count` in all; none where there are no edges.
Points samplesOf(const Mesh& surface, const SharpEdges& sharp, std::size_t count);

}  // namespace innermap
