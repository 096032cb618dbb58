// Lengths of paths through the nodes that are inside.
#pragma once

#include <vector>

#include "lattice/lattice_signs.h"

namespace innermap {

// From each node inside to the nearest start, along edges between nodes inside, in spacings. from:
// #nodes, what the path has behind it at a start, and the largest float elsewhere; the result has
// that where no start is reached. Dijkstra's method.
std::vector<float> distancesInside(const LatticeSigns& signs, std::vector<float> from);

// From each node inside to the solid's surface, in spacings: beyond the band too, where the
// distances are cut off.
std::vector<float> depthsInside(const LatticeSigns& signs);

}  // namespace innermap
