// Points thinned to a blue-noise set.
#pragma once

#include <cstddef>
#include <vector>

#include "innermap/core/vec3.h"

namespace innermap {

// Weighted sample elimination (Yuksel, "Sample Elimination for Generating Poisson Disk Sample
// Sets", Eurographics 2015): indices (ascending) of the `count` of `points` that are kept,
// the points lying on a surface of area `area`.
std::vector<std::size_t> eliminateSamples(const Points& points, std::size_t count, double area);

}  // namespace innermap
