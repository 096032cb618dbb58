// Walls and gaps that a lattice is too coarse for: the nodes in them are made to be inside or
// outside.
#pragma once

#include "innermap/levelset/solid.h"
#include "lattice/lattice_signs.h"

namespace innermap {

struct ThinParts {
  std::vector<std::size_t> walls, gaps;  // nodes nearest to the middles of thin walls and gaps,
                                         // that are on the wrong side; sorted
  std::size_t points = 0;                // of the surface that were looked from
  std::size_t lost = 0;                  // points of the surface with no node inside within reach
};

// Looks for them from points of the surface, about half a spacing apart: the node nearest to the
// point that lies 0.56 of a spacing deeper (no point is farther from all nodes) is inside unless
// the wall is thinner than that.
ThinParts thinParts(const Solid& solid, const LatticeSigns& signs);

}  // namespace innermap
