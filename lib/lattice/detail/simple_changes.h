// Nodes of a lattice that change sides one at a time, without a change of topology.
#pragma once

#include <vector>

#include "lattice/lattice_signs.h"

namespace innermap {

using Sides = std::vector<NodeSide>;  // #nodes

// Changes nodes to the side `to` where they are wanted on it, as far as each is a simple point
// (Bertrand, "Simple points, topological numbers and geodesic neighborhoods in cubic grids", 1994):
// the highest of `order` first, of those that can. wanted, order: #nodes.
void changeSimply(LatticeSigns& signs, const Sides& wanted, NodeSide to,
                  const std::vector<float>& order);

// The same as far as no node joins what is apart on the side `to` around it: what lies between may
// be divided, but is not pierced.
void changeWithoutPiercing(LatticeSigns& signs, const Sides& wanted, NodeSide to,
                           const std::vector<float>& order);

}  // namespace innermap
