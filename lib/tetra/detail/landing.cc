#include "tetra/detail/landing.h"

#include <algorithm>

#include "innermap/core/run.h"

namespace innermap {
namespace {

constexpr int kPasses = 12;
constexpr int kLoosePasses = 8;  // in which those about one that does not arrive slide again
constexpr int kLandingHalvings = 5;

class Lander {
 public:
  Lander(const CellSystem& system, const GuideSurface& surface, double least, CarriedCells& cells)
      : system_(system), surface_(surface), least_(least), cells_(cells) {}

  // Whether it arrived.
  bool land(int v, double tolerance) {
    Vec3& at = cells_.positions[v];
    SurfacePoint& place = cells_.onSurface[v];
    const ClosestPoint found = surface_.closestFrom(place.triangle, at);
    place = found.address;
    if (found.distance <= tolerance) return true;
    const Vec3 from = at;
    const std::vector<double> floor = floorOf(v);
    if (goodAt(v, found.position, floor)) return true;
    // Where the surface creases, the closest point may be one that no good tetrahedra reach, while
    // one beside it is.
    const Vec3 middle = middleOf(v);
    for (const double share : {1.0, 0.5, 0.25}) {
      const ClosestPoint beside =
          surface_.closestFrom(place.triangle, from + share * (middle - from));
      if (!goodAt(v, beside.position, floor)) continue;
      place = beside.address;
      return true;
    }
    double share = 0.5;
    for (int k = 0; k < kLandingHalvings; ++k, share /= 2)
      if (goodAt(v, from + share * (found.position - from), floor)) return false;
    at = from;
    return false;
  }

 private:
  // One that is poor already must not get poorer.
  std::vector<double> floorOf(int v) const {
    std::vector<double> floor;
    for (std::size_t i = system_.first[v]; i < system_.first[v + 1]; ++i)
      floor.push_back(std::min(least_, system_.quality(cells_.positions, system_.around[i])));
    return floor;
  }

  bool goodAt(int v, const Vec3& p, const std::vector<double>& floor) {
    cells_.positions[v] = p;
    for (std::size_t i = 0; i < floor.size(); ++i)
      if (!(system_.quality(cells_.positions, system_.around[system_.first[v] + i]) >= floor[i]))
        return false;
    return true;
  }

  // Of its neighbours on the boundary.
  Vec3 middleOf(int v) const {
    Vec3 sum;
    double count = 0;
    for (std::size_t i = system_.first[v]; i < system_.first[v + 1]; ++i)
      for (const int w : system_.tets[system_.around[i]])
        if (w != v && system_.onBoundary[w]) {
          sum += cells_.positions[w];
          ++count;
        }
    return count > 0 ? sum / count : cells_.positions[v];
  }

  const CellSystem& system_;
  const GuideSurface& surface_;
  double least_;
  CarriedCells& cells_;
};

}  // namespace

std::vector<int> land(const CellSystem& system, const GuideSurface& surface, std::vector<int> slid,
                      double tolerance, const PatchSolverSettings& settings, CarriedCells& cells) {
  Lander lander(system, surface, settings.least, cells);
  std::vector<int> off;
  for (int pass = 0; pass < kPasses; ++pass) {
    throwIfCancelled();
    off.clear();
    for (const int v : slid)
      if (!lander.land(v, tolerance)) off.push_back(v);
    if (off.empty() || pass + 1 == kPasses) break;
    std::vector<int> seeds;
    for (const int v : off)
      for (std::size_t i = system.first[v]; i < system.first[v + 1]; ++i)
        seeds.push_back(system.around[i]);
    const bool loose = pass < kLoosePasses;
    PatchSolverSettings again = settings;
    again.stiffness = settings.stiffness * settings.most;
    again.growth = 1;
    if (!loose) again.rounds = 4;
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
