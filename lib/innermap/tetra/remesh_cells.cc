#include "innermap/tetra/remesh_cells.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>

#include "innermap/core/error.h"
#include "innermap/core/parallel.h"
#include "innermap/tetra/cell_locator.h"
#include "innermap/tetra/detail/cell_system.h"
#include "innermap/tetra/detail/guide_surface.h"
#include "innermap/tetra/tetrahedralize.h"

namespace innermap {
namespace {

constexpr std::size_t kBlock = 1024;
constexpr std::size_t kFewInverted = 64;  // of which patches make short work

// What one level does, as a piecewise linear map.
struct Level {
  CellMesh mesh;
  CellLocator locator;
  Points ways;
};

class Remesher {
 public:
  Remesher(const MappedSolid& mapped, const RemeshSettings& settings)
      : mapped_(mapped),
        settings_(settings),
        own_(targetSurface(mapped)),
        surface_(settings.target ? *settings.target : own_),
        guide_(surface_.vertices, surface_.triangles) {}

  Remesh run(const CellMesh& mesh) {
    Remesh out;
    timed(out.seconds, "carry", [&] {
      out.carry = carried(mesh);
      out.cells = std::move(out.carry.cells);
      out.carry.cells = {};
    });
    out.invertedCarried = out.invertedStart = invertedCells(mesh, out.cells.positions);
    std::optional<Level> level;
    if (settings_.coarse > 0 && out.invertedCarried > kFewInverted)
      timed(out.seconds, "coarse", [&] {
        for (int resolution = settings_.coarse; resolution <= 1024; resolution *= 2)
          if (!refine(resolution, mesh.tetrahedra.size() + 5 * mesh.hexahedra.size(), level)) break;
        if (level) out.start = startFrom(*level, mesh, out.cells, out.invertedStart);
      });
    timed(out.seconds, "repair", [&] { out.repair = repaired(mesh, out.cells); });
    return out;
  }

 private:
  CellCarry carried(const CellMesh& mesh) const {
    CarryCellsSettings carrying;
    carrying.farthest = settings_.farthest;
    carrying.progress = settings_.progress;
    CellCarry out = carryCells(mesh, mapped_, carrying);
    if (settings_.target) layOnTarget(mesh, out.cells);
    return out;
  }

  // From the map's own surface onto the one given.
  void layOnTarget(const CellMesh& mesh, CarriedCells& cells) const {
    (void)mesh;
    parallelBlocks(cells.positions.size(), kBlock, [&](std::size_t begin, std::size_t end) {
      for (std::size_t v = begin; v < end; ++v) {
        if (cells.onSurface[v].triangle < 0) continue;
        const ClosestPoint at = guide_.closest(cells.positions[v]);
        cells.positions[v] = at.position;
        cells.onSurface[v] = at.address;
      }
    });
  }

  CellRepair repaired(const CellMesh& mesh, CarriedCells& cells) const {
    RepairCellsSettings repairing;
    repairing.progress = settings_.progress;
    return repairCells(mesh, surface_, cells, repairing);
  }

  // The next level from the one before; false where it would not be coarser than the mesh.
  bool refine(int resolution, std::size_t cells, std::optional<Level>& level) const {
    TetrahedralizeSettings filling;
    filling.resolution = resolution;
    filling.maxMemory = settings_.maxMemory;
    filling.progress = settings_.progress;
    CellMesh mesh = tetrahedralize(mapped_.solid(), filling);
    if (3 * mesh.tetrahedra.size() > cells) return false;
    CarriedCells moved = carried(mesh).cells;
    const Points before = moved.positions;
    std::size_t inverted = invertedCells(mesh, before);
    if (level) startFrom(*level, mesh, moved, inverted);
    repaired(mesh, moved);
    CellLocator locator(mesh.vertices, mesh.tetrahedra);
    Points ways(before.size());
    for (std::size_t v = 0; v < ways.size(); ++v) ways[v] = moved.positions[v] - before[v];
    level = Level{std::move(mesh), std::move(locator), std::move(ways)};
    return true;
  }

  CarriedCells displaced(const Level& level, const CellMesh& mesh, const CarriedCells& cells,
                         bool boundaryToo) const {
    CarriedCells out = cells;
    parallelBlocks(
        out.positions.size(), kBlock,
        [&](std::size_t begin, std::size_t end) {
          for (std::size_t v = begin; v < end; ++v) {
            SurfacePoint& place = out.onSurface[v];
            if (place.triangle >= 0 && !boundaryToo) continue;
            CellPoint at = level.locator.locate(mesh.vertices[v]);
            if (at.tetrahedron < 0) continue;
            double sum = 0;  // not beyond the coarse mesh's boundary
            for (double& b : at.barycentric) sum += b = std::max(0.0, b);
            for (double& b : at.barycentric) b /= sum;
            out.positions[v] += valueAt(level.ways, level.mesh.tetrahedra, at);
            if (place.triangle < 0) continue;
            const ClosestPoint on = guide_.closestFrom(place.triangle, out.positions[v]);
            out.positions[v] = on.position;
            place = on.address;
          }
        },
        settings_.progress);
    return out;
  }

  CoarseStart startFrom(const Level& level, const CellMesh& mesh, CarriedCells& cells,
                        std::size_t& inverted) const {
    CoarseStart best = CoarseStart::none;
    const CarriedCells given = cells;
    for (const CoarseStart start : {CoarseStart::inside, CoarseStart::all}) {
      CarriedCells moved = displaced(level, mesh, given, start == CoarseStart::all);
      const std::size_t count = invertedCells(mesh, moved.positions);
      if (count >= inverted) continue;
      inverted = count;
      cells = std::move(moved);
      best = start;
    }
    return best;
  }

  const MappedSolid& mapped_;
  const RemeshSettings& settings_;
  const Mesh own_;
  const Mesh& surface_;
  const GuideSurface guide_;
};

}  // namespace

Remesh remeshCells(const CellMesh& mesh, const MappedSolid& mapped,
                   const RemeshSettings& settings) {
  if (settings.coarse != 0 && (settings.coarse < 8 || settings.coarse > 256))
    throw SettingError("coarse", fmt::format("{} is neither 0 nor 8 to 256", settings.coarse));
  return Remesher(mapped, settings).run(mesh);
}

}  // namespace innermap
