// Which nodes of a lattice are inside a solid, and which are moved onto its surface.
#pragma once

#include <cstdint>
#include <vector>

#include "innermap/levelset/solid.h"
#include "lattice/detail/bcc_lattice.h"

namespace innermap {

struct LatticeSigns {
  BccLattice lattice;
  std::vector<float> distance;      // #nodes, signed, cut off at two spacings; world units
  std::vector<NodeSide> side;       // #nodes
  std::vector<std::int8_t> onEdge;  // #nodes: for those on the surface, the direction of the edge
                                    // whose cut they stand at; else -1
};

// Cuts nearer to an end than this share of the edge make poor tetrahedra (Labelle and Shewchuk,
// table 1, "safe").
inline double leastCut(int direction) { return direction < kLongDirections ? 0.24999 : 0.41189; }

// The lattice over the solid's box and signed distances at its nodes, each inside or outside.
LatticeSigns latticeSigns(const Solid& solid, double spacing);

// Where the surface cuts the edge from `node`, as the distances say, as a share of the edge; 1 or 0
// where sides and distances disagree, from a node inside or outside to one on the other side.
double cutShare(const LatticeSigns& signs, std::size_t node, int direction);

// Moves nodes that have a cut too near onto the nearest one (side becomes `on`), where what is
// inside stays a manifold and keeps its topology.
void warpNodes(LatticeSigns& signs);

}  // namespace innermap
