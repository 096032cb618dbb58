// The points that a pair's map is fitted to on a shell or sphere of charges.
#pragma once

#include <cstdint>
#include <optional>

#include "fit/detail/problem_samples.h"
#include "innermap/fit/boundary_pair.h"

namespace innermap {

struct PairProblemSettings {
  PointCounts counts;
  bool vertices = true;               // the mesh's own vertices too
  std::optional<double> radiusRatio;  // charges on a sphere of that many half diagonals
  std::uint64_t seed = 1;
};

// Holds a reference to the pair.
FitProblem pairProblem(const BoundaryPair& pair, const PairProblemSettings& settings);

}  // namespace innermap
