// Fields of a mesh as they are where it is carried.
#pragma once

#include <vector>

#include "innermap/lattice/cell_mesh.h"

namespace innermap {

// The fields of `given`, a mesh of which `made` has the vertices numbered `vertices` and cells that
// were the ones numbered `cells`; turned by the linear map of each cell of `made` from its places
// in `source` to its own. Directions alone are turned.
void turnFields(const CellMesh& given, const std::vector<int>& vertices,
                const std::vector<int>& cells, const Points& source, CellMesh& made);

}  // namespace innermap
