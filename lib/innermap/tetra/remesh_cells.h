// The mesh of one solid made that of another by a map between them: carried, and repaired until no
// cell is inside out.
#pragma once

#include <cstddef>
#include <cstdint>

#include "innermap/boundary/mapped_solid.h"
#include "innermap/core/progress.h"
#include "innermap/core/stage_seconds.h"
#include "innermap/tetra/carry_cells.h"
#include "innermap/tetra/cell_mesh.h"
#include "innermap/tetra/repair_cells.h"

namespace innermap {

struct RemeshSettings {
  // The boundary goes onto this surface; null: onto the map's own, which is that of its source's
  // triangles between the places that their corners go to.
  const Mesh* target = nullptr;
  double farthest = 0.05;  // as CarryCellsSettings::farthest
  // Cells along the longest side of the coarse mesh of the source that is repaired first, in
  // [8, 256]; 0: none.
  int coarse = 32;
  std::uint64_t maxMemory = 0;  // bytes; 0 means no limit
  Progress* progress = nullptr;
};

// The displacements that repairing a coarser mesh took, and how they were used.
enum class CoarseStart { none, inside, all };

struct Remesh {
  CarriedCells cells;               // places on the surface: of the target
  CellCarry carry;                  // without its cells
  std::size_t invertedCarried = 0;  // before anything was repaired
  CoarseStart start = CoarseStart::none;
  std::size_t invertedStart = 0;  // after the displacements of the coarser mesh
  CellRepair repair;
  StageSeconds seconds;  // "carry", "coarse", "repair"
};

// Carries the mesh (carryCells) and repairs it (repairCells), coarse to fine: where cells are
// inverted, meshes of the solid of `coarse`, twice as many, ... cells, as long as they are coarser
// than `mesh`, are carried and repaired first, each from the one before, and the ways that took are
// interpolated to the next: all of them, or of the vertices inside alone, or none, whichever leaves
// the fewest inverted. Deterministic, the same for any number of threads. Throws as those,
// MemoryError.
Remesh remeshCells(const CellMesh& mesh, const MappedSolid& mapped,
                   const RemeshSettings& settings = {});

}  // namespace innermap
