// Poorly shaped tetrahedra of a carried mesh made better: swaps, collapses, vertices moved.
#pragma once

#include <cstddef>
#include <vector>

#include "innermap/lattice/cell_mesh.h"
#include "innermap/mesh/mesh.h"

namespace innermap {

struct ImproveCellsSettings {
  double angle = 12;  // degrees: tetrahedra with a dihedral angle below it, or as near to 180, are
                      // worked on; in [1, 30]
  bool connect = true;  // change the connectivity; else vertices move alone
  int passes = 6;       // at most, in [1, 100]
};

struct CellImprovement {
  std::size_t poorBefore = 0, poorAfter = 0;  // tetrahedra with such an angle
  std::size_t swaps = 0, collapses = 0;
  // #T of the mesh as it is now: the number that each had, or that of the one that was where it is
  // now.
  std::vector<int> origin;
};

// Works on the tetrahedra of `mesh` as they lie at `carried`: edges and faces are swapped for
// others, edges drawn together, vertices moved, those of the boundary along the surface, wherever
// that raises the least angle there (after Klingner and Shewchuk, "Aggressive tetrahedral mesh
// improvement", 2007). The boundary's triangles stay as they are but for their corners' places;
// only a vertex that is off the surface is drawn into a neighbour that is not. No tetrahedron
// becomes inverted, neither carried nor in the mesh itself: the piecewise linear map between the
// two stays one. Vertices that are not used any more stay, unused. Meshes with hexahedra are left
// as they are. Deterministic, the same for any number of threads. Throws SettingError, DataError
// where sizes disagree, Cancelled.
CellImprovement improveCells(CellMesh& mesh, const Mesh& surface, CarriedCells& carried,
                             const ImproveCellsSettings& settings = {});

}  // namespace innermap
