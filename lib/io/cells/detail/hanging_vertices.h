#pragma once

#include <cstdint>

#include "innermap/lattice/cell_mesh.h"

namespace innermap {

// Vertices in the middle of an edge of a cell, or of a hexahedron's face, that is not theirs: where
// a mesh was refined beside cells that were not. Within a millionth of the edge's length.
std::uint64_t countHangingVertices(const CellMesh& mesh);

}  // namespace innermap
