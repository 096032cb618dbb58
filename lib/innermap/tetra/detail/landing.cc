#include "innermap/tetra/detail/landing.h"

#include <algorithm>

namespace innermap {
namespace {

constexpr int kPasses = 12;
constexpr int kLoosePasses = 8;  // in which those about one that does not arrive slide again
constexpr int kHalvings = 5;

// Whether it arrived.
bool landOne(const CellSystem& system, const GuideSurface& surface, int v, double tolerance,
             double least, CarriedCells& cells) {
  Vec3& at = cells.positions[v];
  const ClosestPoint found = surface.closestFrom(cells.onSurface[v].triangle, at);
  cells.onSurface[v] = found.address;
  if (found.distance <= tolerance) return true;
  const Vec3 from = at;
  std::vector<double> floor;  // one that is poor already must not get poorer
  for (std::size_t i = system.first[v]; i < system.first[v + 1]; ++i)
    floor.push_back(std::min(least, system.quality(cells.positions, system.around[i])));
  double share = 1;
  for (int k = 0; k <= kHalvings; ++k, share /= 2) {
    at = k == 0 ? found.position : from + share * (found.position - from);
    bool good = true;
    for (std::size_t i = system.first[v]; good && i < system.first[v + 1]; ++i)
      good = system.quality(cells.positions, system.around[i]) >= floor[i - system.first[v]];
    if (good) return k == 0;
  }
  at = from;
  return false;
}

}  // namespace

std::vector<int> land(const CellSystem& system, const GuideSurface& surface, std::vector<int> slid,
                      double tolerance, const PatchSettings& settings, CarriedCells& cells) {
  std::vector<int> off;
  for (int pass = 0; pass < kPasses; ++pass) {
    throwIfCancelled(settings.progress);
    off.clear();
    for (const int v : slid)
      if (!landOne(system, surface, v, tolerance, settings.least, cells)) off.push_back(v);
    if (off.empty() || pass + 1 == kPasses) break;
    std::vector<int> seeds;
    for (const int v : off)
      for (std::size_t i = system.first[v]; i < system.first[v + 1]; ++i)
        seeds.push_back(system.around[i]);
    const bool loose = pass < kLoosePasses;
    PatchSettings again = settings;
    again.stiffness = settings.stiffness * settings.most;
    again.growth = 1;
    again.rounds = 4;
    const auto patches = growPatches(system, seeds, 2 + pass / 4, loose);
    solvePatches(system, surface, patches, again, true, cells);
    if (!loose) continue;
    for (const CellPatch& patch : patches)
      for (std::size_t i = 0; i < patch.moving; ++i)
        if (system.onBoundary[patch.vertices[i]]) slid.push_back(patch.vertices[i]);
    std::sort(slid.begin(), slid.end());
    slid.erase(std::unique(slid.begin(), slid.end()), slid.end());
  }
  return off;
}

}  // namespace innermap
