// Points in groups of neighbours.
#pragma once

#include <cstddef>
#include <vector>

#include "innermap/core/vec3.h"

namespace innermap {

// Indices of `points` in clusters of at most `largest`, by halving at the median of the longest
// side of the box; every index in exactly one cluster. Deterministic. largest >= 1.
std::vector<std::vector<std::size_t>> clusterPoints(const Points& points, std::size_t largest);

// Indices, ascending, of the points in the box widened by `margin` on all sides.
std::vector<std::size_t> pointsWithin(const Points& points, const Box3& box, double margin);

}  // namespace innermap
