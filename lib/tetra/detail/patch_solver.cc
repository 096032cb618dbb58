#include "tetra/detail/patch_solver.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "innermap/core/run.h"
#include "lattice/untangle.h"

namespace innermap {
namespace {

constexpr double kCellsAVertex = 6;  // about, of tetrahedra; 8 corners of hexahedra

// A patch in its own units: edges of about 1, about its first vertex.
class LocalPatch {
 public:
  LocalPatch(const CellSystem& system, const CellPatch& patch, const CarriedCells& cells)
      : system_(system), patch_(patch), origin_(cells.positions[patch.vertices.front()]) {
    makeTets(cells.positions);
    for (const int v : patch.vertices)
      tets.vertices.push_back((1 / unit_) * (cells.positions[v] - origin_));
    tets.free.assign(patch.vertices.size(), 0);
    std::fill_n(tets.free.begin(), patch.moving, 1);
    onSurface.resize(patch.moving);
    for (std::size_t i = 0; i < patch.moving; ++i) {
      onSurface[i] = cells.onSurface[patch.vertices[i]];
      if (onSurface[i].triangle >= 0) sliding.push_back(static_cast<int>(i));
    }
  }

  Vec3 toLocal(const Vec3& p) const { return (1 / unit_) * (p - origin_); }
  Vec3 toWorld(const Vec3& p) const { return origin_ + unit_ * p; }

  TetPatch tets;
  std::vector<SurfacePoint> onSurface;  // of those that move
  std::vector<int> sliding;             // of those that move, on the boundary

 private:
  void makeTets(const Points& at) {
    std::vector<std::pair<int, int>> numbers;
    for (std::size_t i = 0; i < patch_.vertices.size(); ++i)
      numbers.emplace_back(patch_.vertices[i], static_cast<int>(i));
    std::sort(numbers.begin(), numbers.end());
    double rest = 0, now = 0, folded = 0;
    for (const int t : patch_.tets) {
      std::array<int, 4> tet{};
      for (std::size_t i = 0; i < 4; ++i)
        tet[i] =
            std::lower_bound(numbers.begin(), numbers.end(), std::make_pair(system_.tets[t][i], 0))
                ->second;
      tets.tets.push_back(tet);
      tets.rest.push_back(system_.rest(t));
      rest += std::abs(1 / determinant(tets.rest.back()));
      const double volume = 6 * signedVolume(at, system_.tets[t]);
      now += volume;
      folded += std::abs(volume);
    }
    const double count = static_cast<double>(patch_.tets.size());
    unit_ = std::cbrt((now > 0.1 * folded ? now : folded) / count);
    if (!(unit_ > 0)) unit_ = 1;
    const double restUnit = std::cbrt(rest / count);
    for (Mat3& m : tets.rest)
      for (auto& row : m)
        for (double& x : row) x *= restUnit;
  }

  const CellSystem& system_;
  const CellPatch& patch_;
  Vec3 origin_;
  double unit_ = 1;
};

std::size_t poorOf(const CellSystem& system, const CellPatch& patch, const Points& at,
                   double least) {
  std::size_t poor = 0;
  for (const int t : patch.tets) poor += !(system.quality(at, t) >= least);
  return poor;
}

// Springs of what slides, about where it is now.
void placeSprings(const GuideSurface& surface, double stiffness, LocalPatch& local) {
  parallelBlocks(local.sliding.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s) {
      const int v = local.sliding[s];
      SurfacePoint& address = local.onSurface[v];
      const ClosestPoint found =
          surface.closestFrom(address.triangle, local.toWorld(local.tets.vertices[v]));
      address = found.address;
      local.tets.springs[s] = {v, local.toLocal(found.position), surface.normal(address.triangle),
                               stiffness};
    }
  });
}

}  // namespace

PatchResult solvePatch(const CellSystem& system, const GuideSurface& surface,
                       const CellPatch& patch, const PatchSolverSettings& settings, bool always,
                       CarriedCells& cells) {
  PatchResult result;
  result.poorBefore = poorOf(system, patch, cells.positions, settings.least);
  LocalPatch local(system, patch, cells);
  const double first = settings.stiffness * kCellsAVertex;
  local.tets.springs.resize(local.sliding.size());
  placeSprings(surface, first, local);
  if (settings.anchor > 0 && settings.anchors)
    for (const int v : local.sliding)
      local.tets.springs.push_back({v,
                                    local.toLocal((*settings.anchors)[patch.vertices[v]]),
                                    {},
                                    settings.anchor * kCellsAVertex});
  UntangleSettings untangling;
  untangling.volumeShare = settings.volumeShare;
  untangling.rounds = settings.rounds;
  if (!local.sliding.empty())
    untangling.afterRound = [&](TetPatch&, int round) {
      placeSprings(surface, first * std::min(settings.most, std::pow(settings.growth, round + 1)),
                   local);
    };
  untangle(local.tets, untangling);
  Points before(patch.moving);
  for (std::size_t i = 0; i < patch.moving; ++i) {
    Vec3& at = cells.positions[patch.vertices[i]];
    before[i] = at;
    at = local.toWorld(local.tets.vertices[i]);
  }
  result.poorAfter = poorOf(system, patch, cells.positions, settings.least);
  if (result.poorAfter < result.poorBefore || (always && result.poorAfter == result.poorBefore)) {
    for (std::size_t i = 0; i < patch.moving; ++i)
      cells.onSurface[patch.vertices[i]] = local.onSurface[i];
    return result;
  }
  for (std::size_t i = 0; i < patch.moving; ++i) cells.positions[patch.vertices[i]] = before[i];
  result.poorAfter = result.poorBefore;
  return result;
}

std::size_t solvePatches(const CellSystem& system, const GuideSurface& surface,
                         const std::vector<CellPatch>& patches, const PatchSolverSettings& settings,
                         bool always, CarriedCells& cells) {
  std::atomic<std::size_t> poor{0};
  parallelBlocks(patches.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t p = begin; p < end; ++p)
      poor += solvePatch(system, surface, patches[p], settings, always, cells).poorAfter;
  });
  return poor;
}

}  // namespace innermap
