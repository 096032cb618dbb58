// Makes the mesh of one solid that of another by a map between them: carries it, and repairs it
// until no cell is inside out.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "innermap/core/run.h"
#include "innermap/core/setting.h"
#include "innermap/fit/mapped_solid.h"
#include "innermap/lattice/cell_mesh.h"
#include "innermap/mesh/mesh.h"
#include "innermap/tetra/cells.h"

namespace innermap {

// Poorly shaped tetrahedra of a carried mesh made better: swaps, collapses, vertices moved.

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

// Improves the tetrahedra of `mesh` as they lie at `carried`. Swaps edges and faces, collapses
// edges and moves vertices, those of the boundary along the surface, wherever that raises the least
// angle there (after Klingner and Shewchuk, "Aggressive tetrahedral mesh improvement", 2007). The
// boundary keeps its triangles, though their corners may move; an edge of it collapses only if one
// end is off the surface, into the end that is on it. No tetrahedron becomes inverted, neither
// carried nor in the mesh itself, so the two stay a piecewise linear map. Vertices no longer used
// stay in the list. Meshes with hexahedra stay as they are.
// Deterministic, the same for any number of threads. Throws SettingError, DataError
// where sizes disagree, Cancelled.
CellImprovement improveCells(CellMesh& mesh, const Mesh& surface, CarriedCells& carried,
                             const ImproveCellsSettings& settings = {});

// Repairs cells that a map turned inside out by moving vertices, those of the boundary along a
// surface.

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
  std::size_t invertedAtRest = 0;       // of the mesh as it was given
  std::size_t invertedAfter = 0;        // the repair
  std::size_t poorAfter = 0;            // tetrahedra below settings.least
  std::size_t slid = 0;                 // vertices of the boundary that moved
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
// turns. Patches run side by side. The numbers returned tell what remains. Deterministic, the
// same for any number of threads. Throws SettingError, DataError where sizes disagree, Cancelled.
CellRepair repairCells(const CellMesh& mesh, const Mesh& surface, CarriedCells& carried,
                       const RepairCellsSettings& settings = {});

struct RemeshSettings {
  // The other way: brings a mesh that fills the map's target to its source.
  bool back = false;
  // The boundary goes onto this surface, which must be the solid's own but for how it is cut into
  // triangles; null: onto that of the map, whose triangles are the source's.
  const Mesh* surface = nullptr;
  bool keepConnectivity = false;  // shapes are improved by moving vertices alone
  double angle = 10;              // degrees, in [1, 30]; as ImproveCellsSettings::angle
  // Farthest that a vertex of the boundary may be from the surface of the solid that it should
  // fill, fraction of its diagonal, in (0, 1].
  double farthest = 0.05;
  // Cells along the longest side of the source, in [8, 256]: of the coarse mesh that is repaired
  // first (0: none), and back, of the mesh that stands for the inverse map (0: 64).
  int coarse = 32;
};

// Without the surface and `farthest`.
std::vector<Setting> describe(RemeshSettings& settings);

struct Remesh {
  // Where the map takes it. Its vertices' fields have one more, "source": the places that they came
  // from; its cells' fields have their quality. Vertices that were drawn into others are gone.
  CellMesh mesh;
  std::size_t invertedAtRest = 0;   // of the mesh given
  std::size_t invertedCarried = 0;  // before anything was repaired
  bool fromCoarse = false;          // the coarse mesh's displacements were used
  CellRepair repair;                // moved, farthestMoved: over all that was done
  std::size_t inverted = 0;         // in the end
  std::size_t swaps = 0, collapses = 0;
  // Of the boundary's vertices from the surface, fractions of its diagonal; what lies between them
  // cuts corners, see boundary_fit.h.
  double boundaryRms = 0, boundaryMax = 0;
  CellQuality quality;
  CellProof proof;        // of mesh
  CellProof sourceProof;  // of its cells where the field "source" has their vertices
  std::vector<std::string> notes, warnings;
  StageSeconds seconds;  // "carry", "coarse", "repair", "shapes", "proof"
};

// Carries the mesh (tetra/cells.h), repairs it and improves its tetrahedra's shapes, in turns until
// the boundary lies on the surface.
//
// Coarse to fine: if many cells are inverted, it first carries and repairs meshes of the source
// that are coarser than `mesh`: of `coarse` cells, twice as many, and so on. Each starts from the
// displacements of the one before: those of all vertices, of the vertices inside alone, or none,
// whichever leaves the fewest inverted.
//
// Back: a harmonic map that folds has no inverse. So a mesh of the source is carried and repaired,
// which gives a piecewise linear, one-to-one map. The vertices of the target's mesh are found in
// its tetrahedra, those of the boundary by their places on the surface. Cells that this inverts are
// repaired as above.
//
// Fields: the Jacobian of the piecewise linear map turns vectors and normals; at a vertex, the mean
// of the Jacobians of the cells about it. Changed cells take the values of the cell that was
// there. Deterministic, the same for any number of threads. Throws SettingError, DataError as
// carryCells, MemoryError, Cancelled.
Remesh remeshCells(const CellMesh& mesh, const MappedSolid& mapped,
                   const RemeshSettings& settings = {});

// Need in bytes, beside the mesh and the map.
std::uint64_t remeshMemory(const CellMesh& mesh);

}  // namespace innermap
