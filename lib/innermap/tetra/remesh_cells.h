// The mesh of one solid made that of another by a map between them: carried, and repaired until no
// cell is inside out.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "innermap/boundary/mapped_solid.h"
#include "innermap/core/setting.h"
#include "innermap/core/stage_seconds.h"
#include "innermap/lattice/cell_mesh.h"
#include "innermap/tetra/cell_quality.h"
#include "innermap/tetra/improve_cells.h"
#include "innermap/tetra/repair_cells.h"

namespace innermap {

struct RemeshSettings {
  // The other way: the mesh fills the map's target and is brought to its source.
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
  std::vector<std::string> notes, warnings;
  StageSeconds seconds;  // "carry", "coarse", "repair", "shapes"
};

// Carries the mesh (carry_cells.h), repairs it (repair_cells.h) and improves its tetrahedra's
// shapes (improve_cells.h), in turns until the boundary lies on the surface.
//
// Coarse to fine: where many cells are inverted, meshes of the source of `coarse`, twice as many,
// ... cells, as long as they are coarser than `mesh`, are carried and repaired first, each from the
// one before, and the ways that took are interpolated to the next: all of them, or of the vertices
// inside alone, or none, whichever leaves the fewest inverted.
//
// Back: a harmonic map is not inverted where it folds. Instead a mesh of the source is carried and
// repaired; with that it is piecewise linear and one-to-one, and the vertices of the target's mesh
// are found in its tetrahedra; those of the boundary by their places on the surface. What that
// inverts is repaired as above.
//
// Fields: vectors and normals are turned by the Jacobian of the piecewise linear map, of a vertex
// by the mean of that of the cells about it; changed cells have the values of the one that was
// there. Deterministic, the same for any number of threads. Throws SettingError, DataError as
// carryCells, MemoryError, Cancelled.
Remesh remeshCells(const CellMesh& mesh, const MappedSolid& mapped,
                   const RemeshSettings& settings = {});

// Need in bytes, beside the mesh and the map.
std::uint64_t remeshMemory(const CellMesh& mesh);

}  // namespace innermap
