#include "jobs/tetra/cell_needs.h"

#include <algorithm>

namespace innermap {

MemoryNeed hexahedraNeed(const std::string& name, const Mesh& mesh,
                         const HexahedralizeSettings& settings) {
  return {"hexahedra of " + name, hexahedralizeMemory(mesh, settings),
          "use fewer {blocks} or {pieces}"};
}

MemoryNeed polycubeNeed(const std::string& name, const Mesh& mesh,
                        const PolycubeSettings& settings) {
  return {"a polycube of " + name, polycubeMemory(mesh, settings), "use fewer {blocks}"};
}

MemoryNeed remeshNeed(const std::string& name, const CellMesh& cells, std::uint64_t reading) {
  return {"carrying " + name, std::max(reading, remeshMemory(cells)), "use a coarser mesh"};
}

MemoryNeed compareFemNeed(const Solid& solid, const CompareFemSettings& settings,
                          std::size_t mapped) {
  const std::uint64_t reference = mapped > 0 ? fitMapMemory({}, mapped) : 0;
  return {"finite elements", std::max(compareFemMemory(solid, settings), reference),
          "use lower {resolutions}"};
}

}  // namespace innermap
