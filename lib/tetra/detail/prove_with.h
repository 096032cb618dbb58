// proveCells() of one mesh at several places of its vertices.
#pragma once

#include <optional>

#include "innermap/tetra/cells.h"
#include "lattice/cell_signs.h"

namespace innermap {

// boundary: cellBoundary(mesh), which is looked for where it is needed and not there yet.
CellProof proveWith(const CellMesh& mesh, std::optional<CellBoundary>& boundary);

}  // namespace innermap
