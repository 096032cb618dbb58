// The points that a pair's map is fitted to on a shell or sphere of charges.
#pragma once

#include "innermap/boundary/fit_map.h"

namespace innermap {

struct PointCounts {
  std::size_t sources = 0, collocation = 0, heldOut = 0;
};

PointCounts pointCounts(const ShellSettings& shell);

// With the mesh's own vertices too unless `interpolation` is linear. Holds a reference to the pair.
FitProblem pairProblem(const BoundaryPair& pair, const PointCounts& counts,
                       const FitMapSettings& settings);

}  // namespace innermap
