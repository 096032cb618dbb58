// Cells that a map turned inside out, turned right again by moving vertices, those of the boundary
// along a surface.
#pragma once

#include <cstddef>
#include <vector>

#include "innermap/lattice/cell_mesh.h"
#include "innermap/mesh/mesh.h"

namespace innermap {

struct RepairCellsSettings {
  // A cell counts as turned right where det J / (|J|^2 / 3)^(3/2) of its tetrahedra is at least
  // this, with J from the mesh at rest; in (0, 0.1].
  double least = 1e-4;
  // All vertices move, not those near inverted cells alone; what that does for shapes comes first
  // where cells are few and all are poor.
  bool whole = false;
  // Shapes are to be those of regular tetrahedra and cubes, not of the cells at rest.
  bool regular = false;
  // How strongly vertices of the boundary are held where they were carried, about edges squared to
  // a cell's energy: 0 lets them slide freely along the surface. Not negative.
  double anchor = 0;
  bool slide = true;  // vertices of the boundary may move at all
};

struct CellRepair {
  std::size_t cells = 0;
  std::size_t invertedAtRest = 0;                     // of the mesh as it was given
  std::size_t invertedBefore = 0, invertedAfter = 0;  // carried, and after the repair
  std::size_t poorAfter = 0;                          // tetrahedra below settings.least
  std::size_t slid = 0;                               // vertices of the boundary that moved
  std::size_t notLanded = 0;            // of those, off the surface by over 1e-9 of its diagonal
  double farthestOff = 0;               // of the surface, world units
  double moved = 0, farthestMoved = 0;  // root mean square and largest way, world units
};

// Moves `carried`, where a map took the vertices of `mesh`, until no cell is inside out, and of the
// boundary's vertices as few as that takes, along the surface. A hexahedron is judged by the
// tetrahedra at its corners.
//
// Patches of inverted cells and 2, 4, 6, 9 rings of vertices about them are untangled (untangle.h)
// with the boundary fixed; then patches of 3, 5, 8, 12 rings with the boundary held by springs
// along the surface's normals; then the boundary is laid back on the surface as far as no cell
// turns. Patches run side by side. What remains is told by the numbers returned. Deterministic, the
// same for any number of threads. Throws SettingError, DataError where sizes disagree, Cancelled.
CellRepair repairCells(const CellMesh& mesh, const Mesh& surface, CarriedCells& carried,
                       const RepairCellsSettings& settings = {});

}  // namespace innermap
