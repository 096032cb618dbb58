// What repairing a coarser mesh of the same solid took, used for a finer one.
#pragma once

#include <cstddef>

#include "innermap/lattice/cell_mesh.h"
#include "tetra/detail/guide_surface.h"
#include "transfer/cell_locator.h"

namespace innermap {

// One level: the ways of its vertices, linear between them.
struct CoarseLevel {
  CellMesh mesh;  // at rest
  CellLocator locator;
  Points ways;  // #V
};

// Moves `cells` as the level says, all vertices or those inside alone, whichever leaves fewer cells
// inverted than `inverted`, which becomes their number. Whether that is so.
bool startFrom(const CoarseLevel& level, const GuideSurface& surface, const CellMesh& mesh,
               CarriedCells& cells, std::size_t& inverted);

}  // namespace innermap
