// Tetrahedra that fill the inside of a lattice (Labelle and Shewchuk, "Isosurface Stuffing",
// SIGGRAPH 2007).
#pragma once

#include <vector>

#include "innermap/tetra/cell_mesh.h"
#include "innermap/tetra/detail/lattice_signs.h"

namespace innermap {

struct StuffedMesh {
  Points vertices;  // those from firstBoundary on are on the boundary, no others
  int firstBoundary = 0;
  std::vector<Tetrahedron> tetrahedra;  // each has a vertex that is not on the boundary
};

// Dihedral angles lie in 10.7 to 164.8 degrees. Throws MemoryError when there are more vertices
// than an index can name.
StuffedMesh stuffed(const LatticeSigns& signs, Progress* progress);

}  // namespace innermap
