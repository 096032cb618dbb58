#include "fit/tangle.h"

#include <fmt/format.h>

#include "innermap/core/error.h"

namespace innermap {

MeshReport checkCrossings(const Mesh& mesh) {
  CheckSettings settings;
  settings.listed = 4096;
  return checkMesh(mesh, settings);
}

void refuseTangle(const Mesh& mesh, std::size_t crossings) {
  if (crossings <= kMostCrossings * mesh.triangles.size()) return;
  throw DataError(
      fmt::format("{}: crosses itself nearly everywhere, {} pairs of its {} triangles pass through "
                  "each other; repair it",
                  mesh.name, crossings, mesh.triangles.size()));
}

}  // namespace innermap
