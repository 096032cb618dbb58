#include "tetra/detail/coarse_start.h"

#include "innermap/core/run.h"
#include "tetra/detail/cell_system.h"

namespace innermap {
namespace {

constexpr std::size_t kCoarseBlock = 1024;

}  // namespace

bool startFrom(const CoarseLevel& level, const GuideSurface& surface, const CellMesh& mesh,
               CarriedCells& cells, std::size_t& inverted) {
  CarriedCells inside = cells, all = cells;
  parallelBlocks(cells.positions.size(), kCoarseBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      const CellPoint at = level.locator.locate(mesh.vertices[v]);
      if (at.tetrahedron < 0) continue;
      // Not beyond the coarse mesh's boundary.
      const Vec3 way = valueAt(level.ways, level.mesh.tetrahedra, clamped(at));
      SurfacePoint& place = all.onSurface[v];
      if (place.triangle < 0) {
        inside.positions[v] += way;
        all.positions[v] += way;
        continue;
      }
      const ClosestPoint on = surface.closestFrom(place.triangle, all.positions[v] + way);
      all.positions[v] = on.position;
      place = on.address;
    }
  });
  bool better = false;
  for (CarriedCells* moved : {&inside, &all}) {
    const std::size_t count = invertedCells(mesh, moved->positions);
    if (count >= inverted) continue;
    inverted = count;
    cells = *moved;
    better = true;
  }
  return better;
}

}  // namespace innermap
