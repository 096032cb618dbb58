// Points in groups of neighbours.
#pragma once

#include <cstddef>
#include <limits>
#include <vector>

#include "innermap/core/vec3.h"

namespace innermap {

// Indices of `points` in clusters of at most `largest` whose boxes' sides are at most `widest`;
// every index in exactly one cluster. Clusters that are too large are halved at the median of the
// longest side of their box, those that are only too wide at its middle, so that parts that stand
// apart come apart. Deterministic. largest >= 1, widest > 0.
std::vector<std::vector<std::size_t>> clusterPoints(
    const Points& points, std::size_t largest,
    double widest = std::numeric_limits<double>::infinity());

}  // namespace innermap
