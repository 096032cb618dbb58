// A lattice's inside grown again with as many handles as are wanted.
#pragma once

#include <optional>
#include <vector>

#include "innermap/lattice/outer_surface.h"
#include "lattice/detail/simple_changes.h"

namespace innermap {

struct SolidParts {
  std::vector<Sides> parts;  // pockets filled, the largest first
  std::size_t leftOut = 0;   // below a thousandth of the largest, or all others
  double leftOutShare = 0;   // of the nodes inside
};

// The nodes inside in pieces that hang together, the largest first.
std::vector<std::vector<std::size_t>> piecesInside(const BccLattice& lattice, const Sides& sides);

// All nodes that stand far enough from the lattice's sides for all their neighbours to be nodes.
Sides nodesWithNeighbours(const BccLattice& lattice);

// Makes inside what the outside does not reach.
void fillPockets(const BccLattice& lattice, Sides& sides);

// What hangs together inside; of that the largest alone with `onePiece`.
SolidParts partsOf(const LatticeSigns& signs, bool onePiece);

// Sets the sides to what is grown of `part` (without pockets) by `order` (highest first) from the
// largest of its cores {order at least some value} that has so many handles. Where none are wanted
// and every core has some, it grows from the node of the highest order, if that cuts at buried
// sheets (order below 0) alone. Otherwise false, and the sides are the part's.
bool growWithHandles(LatticeSigns& signs, const Sides& part, int handles,
                     const std::vector<float>& order);

}  // namespace innermap
