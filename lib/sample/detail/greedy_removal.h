// The inner loop of sample elimination: the point of largest weight goes, its
// neighbours become lighter by what it gave them, and so on.
//
// Done on all threads, with the result of the loop as it stands: weights only fall, so a point that
// is heavier than all its neighbours goes at the weight it has, whatever happens elsewhere. Cubes
// of cells remove such points each for themselves and tell one another between rounds. Weights are
// whole numbers, so their sums do not depend on the order either.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "sample/detail/neighbour_grid.h"

namespace innermap {

// What two neighbours give each other, in [0, 1].
struct NeighbourWeight {
  double radius = 1;    // no neighbour beyond it
  double smallest = 0;  // distances below it count as it

  double operator()(double squaredDistance) const {
    const double d = std::max(std::sqrt(squaredDistance), smallest) / radius;
    const double one = 1 - std::min(d, 1.0), two = one * one, four = two * two;
    return four * four;
  }
};

// The `count` points (ascending, in the grid's order) that are left. Of points of equal weight the
// lower index goes.
std::vector<std::size_t> heaviestRemoved(const NeighbourGrid& grid, std::size_t count,
                                         const NeighbourWeight& weight);

}  // namespace innermap
