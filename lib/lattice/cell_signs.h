// Cells by the exact signs of their corners' volumes.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "core/orientation.h"
#include "innermap/lattice/cell_mesh.h"

namespace innermap {

// The sign of signedVolume(), exact (core/orientation.h).
inline Sign signOf(const Points& vertices, const Tetrahedron& cell, std::uint64_t& exact) {
  return orientation(vertices[cell[0]], vertices[cell[1]], vertices[cell[2]], vertices[cell[3]],
                     exact);
}

// Whether it is not known to be right side out. A hexahedron at its corners alone.
inline bool isInverted(const Points& vertices, const Tetrahedron& cell) {
  std::uint64_t exact = 0;
  return signOf(vertices, cell, exact) != Sign::positive;
}
inline bool isInverted(const Points& vertices, const Hexahedron& cell) {
  const auto corners = cornerTetrahedra(cell);
  return std::any_of(corners.begin(), corners.end(),
                     [&](const Tetrahedron& t) { return isInverted(vertices, t); });
}

struct CellBoundary {
  std::vector<Triangle> triangles;  // as boundaryTriangles()
  // Each other face belongs to two cells, one on either side: then the triangles are the cells'
  // boundary as a chain too. Of tetrahedra; hexahedra's quadrilaterals must also agree in their
  // order.
  bool paired = true;
};

CellBoundary cellBoundary(const CellMesh& mesh);

}  // namespace innermap
