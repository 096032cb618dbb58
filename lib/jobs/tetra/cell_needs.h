// What cells in a solid and finite elements on it need of memory.
#pragma once

#include <string>

#include "innermap/tetra/compare_fem.h"
#include "innermap/tetra/hexahedralize.h"
#include "innermap/tetra/remesh_cells.h"
#include "jobs/needs.h"

namespace innermap {

// name: the mesh's; reading: bytes that reading the cells takes.
MemoryNeed hexahedraNeed(const std::string& name, const Mesh& mesh,
                         const HexahedralizeSettings& settings);
MemoryNeed polycubeNeed(const std::string& name, const Mesh& mesh,
                        const PolycubeSettings& settings);
MemoryNeed remeshNeed(const std::string& name, const CellMesh& cells, std::uint64_t reading = 0);

// mapped: vertices of the solid whose map is compared; 0: known functions are.
MemoryNeed compareFemNeed(const Solid& solid, const CompareFemSettings& settings,
                          std::size_t mapped);

}  // namespace innermap
