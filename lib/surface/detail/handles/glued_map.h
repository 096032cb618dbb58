// The map between two surfaces with handles, through their cuts.
#pragma once

#include <vector>

#include "innermap/surface/correspond.h"
#include "surface/detail/handles/cut_alike.h"

namespace innermap {

struct GluedMapSettings {
  // Vertices of A's uncut surface and points of B's, met exactly.
  std::vector<std::pair<int, SurfacePoint>> landmarks;
  bool refine = true;  // lower the energy of the finest map, too
};

struct GluedMap {
  CutSurface cut;  // A's, with vertices of B's rims put in
  Layout image;    // of it on B's cut surface's sphere; rims lie on rims
  // Vertices of `cut` that were held and the points of B's cut surface where they stand.
  std::vector<std::pair<int, SurfacePoint>> exact;
  double energy = 0;
  // For each vertex of A's uncut surface, the point of B's.
  std::vector<SurfacePoint> onTarget;
};

// Coarse to fine with the caps' centres and some points of the rims fixed, then all of the rims.
// Glued again along the cuts, this is a one-to-one map of the uncut surfaces, as both copies of a
// rim's vertex go to copies of one point. Throws DataError where no map without flips is found that
// meets rims and landmarks; Cancelled.
GluedMap gluedMap(const CutPair& pair, const GluedMapSettings& settings = {});

}  // namespace innermap
