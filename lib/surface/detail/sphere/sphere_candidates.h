// First maps of one sphere onto another, rotated and with limbs matched.
#pragma once

#include <cstdint>
#include <vector>

#include "surface/detail/refining/coarse_map.h"
#include "surface/detail/sphere/limb_tips.h"

namespace innermap {

struct SphereCandidateSettings {
  std::vector<Anchor> landmarks;  // fine vertices, and unit vectors; kept in the coarse mesh
  bool aligned = false;           // normals should agree
  bool thorough = true;           // otherwise only rotations and the most promising limbs are tried
  std::size_t kept = 3;
  std::uint64_t seed = 1;
};

// A surface coarsened, and maps of it; `mesh` is the surface's, coarsened.
struct Candidates {
  ProgressiveMesh mesh;
  CoarseSurface coarse;
  std::vector<CoarseMap> maps;  // least energy first, at most `kept`
};

// a and b with their layouts and limb tips. Throws DataError naming the landmarks (by number, from
// 1) that contradict the others or the orientation; Cancelled.
Candidates sphereCandidates(const ClosedSurface& a, const Layout& la, const LimbTips& tipsA,
                            const ClosedSurface& b, const TargetMetric& target,
                            const LimbTips& tipsB, const SphereCandidateSettings& settings);

}  // namespace innermap
