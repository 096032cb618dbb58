#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/require_number.h"
#include "innermap/core/error.h"
#include "innermap/core/run.h"
#include "innermap/tetra/remesh_cells.h"
#include "tetra/detail/cell_system.h"
#include "tetra/detail/guide_surface.h"
#include "tetra/detail/landing.h"
#include "tetra/detail/patch_solver.h"

namespace innermap {
namespace {

constexpr std::array<int, 4> kRings{2, 4, 6, 9};
constexpr std::size_t kManyAPatch = 50;  // tetrahedra
constexpr std::array<int, 4> kSlidingRings{3, 5, 8, 12};
constexpr int kFixedRounds = 10;
constexpr double kLanded = 1e-9;  // of the surface's diagonal

void require(const CellMesh& mesh, const Mesh& surface, const CarriedCells& carried,
             const RepairCellsSettings& settings) {
  requireNumber("least", settings.least, {0, 0.1, true});
  requireNumber("anchor", settings.anchor, {0});
  const std::size_t count = mesh.vertices.size();
  if (carried.positions.size() != count || carried.onSurface.size() != count)
    throw DataError(fmt::format("{}: {} vertices, of which {} were carried, {} with places",
                                mesh.name, count, carried.positions.size(),
                                carried.onSurface.size()));
  for (const SurfacePoint& p : carried.onSurface)
    if (p.triangle < -1 || p.triangle >= static_cast<int>(surface.triangles.size()))
      throw DataError(fmt::format("{}: a place on triangle {} of {} of the surface", mesh.name,
                                  p.triangle, surface.triangles.size()));
}

class Repair {
 public:
  Repair(const CellMesh& mesh, const Mesh& surface, CarriedCells& cells,
         const RepairCellsSettings& settings)
      : mesh_(mesh),
        system_(mesh, settings.regular ? RestShape::regular : RestShape::own),
        surface_(surface.vertices, surface.triangles),
        cells_(cells),
        carried_(cells.positions),
        settings_(settings),
        landed_(kLanded * boundingBox(surface).diagonal()) {
    patch_.least = settings.least;
    patch_.anchor = settings.anchor;
    patch_.anchors = &carried_;
    // Vertices of the boundary without a place stay where they are.
    for (std::size_t v = 0; v < system_.vertices(); ++v)
      if (system_.onBoundary[v] && cells.onSurface[v].triangle < 0)
        cells.onSurface[v] = surface_.closest(cells.positions[v]).address;
      else if (!system_.onBoundary[v])
        cells.onSurface[v].triangle = -1;
  }

  CellRepair run() {
    CellRepair out;
    out.cells = mesh_.tetrahedra.size() + mesh_.hexahedra.size();
    out.invertedAtRest = invertedCells(mesh_, mesh_.vertices);
    std::vector<int> poor = poorTets(system_, cells_.positions, settings_.least);
    const std::size_t first = poor.size();
    if (settings_.whole && !system_.tets.empty()) {
      solvePatches(system_, surface_, {wholePatch(system_, settings_.slide)}, patch_, true, cells_);
      poor = poorTets(system_, cells_.positions, settings_.least);
    } else {
      poor = untangleWith(kRings, false, std::move(poor), first);
    }
    if (settings_.slide) poor = untangleWith(kSlidingRings, true, std::move(poor), first);
    reportProgress("landing", 0);
    const std::vector<int> off = land(system_, surface_, offSurface(), landed_, patch_, cells_);
    measure(off, out);
    return out;
  }

 private:
  template <class Rings>
  std::vector<int> untangleWith(const Rings& rings, bool slide, std::vector<int> poor,
                                std::size_t first) {
    for (const int count : rings) {
      if (poor.empty() || outOfTime()) break;
      reportProgress(slide ? "repairing the boundary" : "repairing",
                     1 - static_cast<double>(poor.size()) / static_cast<double>(first + 1));
      const std::size_t before = poor.size();
      const auto patches = growPatches(system_, poor, count, slide);
      // Few in one place are mostly beside a boundary that is folded itself, where more of the
      // inside does not help; many are a fold of the map, where it does.
      const bool few = before < kManyAPatch * patches.size();
      PatchSolverSettings settings = patch_;
      if (!slide && few) settings.rounds = kFixedRounds;
      solvePatches(system_, surface_, patches, settings, false, cells_);
      poor = poorTets(system_, cells_.positions, settings_.least);
      if (!slide && few && 4 * poor.size() > 3 * before) break;
    }
    return poor;
  }

  std::vector<int> movedBoundary() const {
    std::vector<int> moved;
    for (std::size_t v = 0; v < system_.vertices(); ++v)
      if (system_.onBoundary[v] && squaredNorm(cells_.positions[v] - carried_[v]) > 0)
        moved.push_back(static_cast<int>(v));
    return moved;
  }

  std::vector<int> offSurface() const {
    std::vector<int> off;
    for (std::size_t v = 0; v < system_.vertices(); ++v)
      if (system_.onBoundary[v] && wayOff(static_cast<int>(v)) > landed_)
        off.push_back(static_cast<int>(v));
    return off;
  }

  double wayOff(int v) const {
    return norm(cells_.positions[v] - surface_.position(cells_.onSurface[v]));
  }

  void measure(const std::vector<int>& off, CellRepair& out) const {
    out.invertedAfter = invertedCells(mesh_, cells_.positions);
    out.poorAfter = poorTets(system_, cells_.positions, settings_.least).size();
    out.slid = movedBoundary().size();
    out.notLanded = off.size();
    for (const int v : off) out.farthestOff = std::max(out.farthestOff, wayOff(v));
    double squares = 0;
    for (std::size_t v = 0; v < carried_.size(); ++v) {
      const double way = norm(cells_.positions[v] - carried_[v]);
      squares += way * way;
      out.farthestMoved = std::max(out.farthestMoved, way);
    }
    out.moved = carried_.empty() ? 0 : std::sqrt(squares / static_cast<double>(carried_.size()));
  }

  const CellMesh& mesh_;
  const CellSystem system_;
  const GuideSurface surface_;
  CarriedCells& cells_;
  const Points carried_;
  const RepairCellsSettings& settings_;
  double landed_;
  PatchSolverSettings patch_;
};

}  // namespace

CellRepair repairCells(const CellMesh& mesh, const Mesh& surface, CarriedCells& carried,
                       const RepairCellsSettings& settings) {
  require(mesh, surface, carried, settings);
  return Repair(mesh, surface, carried, settings).run();
}

}  // namespace innermap
