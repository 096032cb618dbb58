// From where the search for a map between two spheres begins.
#pragma once

#include <string>
#include <vector>

#include "surface/detail/refining/anchor_flow.h"
#include "surface/detail/sphere/limb_tips.h"
#include "surface/detail/sphere/rotation_search.h"

namespace innermap {

struct MapStart {
  Mat3 rotation{};            // of A's layout
  std::vector<Anchor> drawn;  // limb tips, by A's vertices, to be brought to B's
  std::string origin;         // in words
  bool promising = false;     // not to be dropped by a rough trial
};

// Each rotation as it is and with the tips that are then each other's nearest; and matchings of
// tips with the rotation that fits them and the landmarks (places in both layouts) best. Promising
// are the best rotations and the first of the matchings that differ: for bodies of one kind
// geodesic distances know best.
std::vector<MapStart> sphereStarts(const std::vector<RotationCandidate>& rotations,
                                   const LimbTips& tipsA, const LimbTips& tipsB,
                                   const Points& landmarksA, const Points& landmarksB);

// Tips of A, standing at `places`, that are a tip of B's nearest and it theirs, and not too far.
TipPairs nearestTips(const Points& places, const LimbTips& b);

// With B's tips as targets.
std::vector<Anchor> anchorsOf(const TipPairs& pairs, const LimbTips& a, const LimbTips& b);

}  // namespace innermap
