// Newton's method for f(p) = q at many points together.
#pragma once

#include <vector>

#include "transfer/detail/extended_map.h"

namespace innermap {

struct NewtonSettings {
  double tolerance = 0;    // of |f(p) - q|, world units of the target
  double longestStep = 0;  // world units of the source
};

struct NewtonResult {
  std::vector<PointImage> at;     // of the map at the points found
  std::vector<double> residuals;  // |f(p) - q|, world units of the target
};

// points: the starts; receives the best found. targets: #points.
NewtonResult solveNewton(const ExtendedMap& map, const Points& targets, Points& points,
                         const NewtonSettings& settings);

}  // namespace innermap
