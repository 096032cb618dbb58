// Tetrahedra that fill the inside of a lattice (Labelle and Shewchuk, "Isosurface Stuffing",
// SIGGRAPH 2007).
#pragma once

#include <vector>

#include "innermap/lattice/cell_mesh.h"
#include "lattice/lattice_signs.h"

namespace innermap {

struct StuffedMesh {
  Points vertices;  // those from firstBoundary on are on the boundary, no others
  int firstBoundary = 0;
  // The first of those on the boundary are nodes that were warped: where they came from.
  Points unwarped;
  std::vector<Tetrahedron> tetrahedra;  // each has a vertex that is not on the boundary
};

// Dihedral angles lie in 12.7 to 155 degrees when no node is warped; when some are, rarely (some in
// 1e8 cells of random data) in less than 10 to 165, see holdWarped(). Throws MemoryError when there
// are more vertices than an index can name.
StuffedMesh stuffed(const LatticeSigns& signs);

// The boundary's triangles, seen from outside counter-clockwise: boundaryTriangles(), but of the
// cells along the boundary alone.
std::vector<Triangle> boundaryOf(const StuffedMesh& mesh);

}  // namespace innermap
