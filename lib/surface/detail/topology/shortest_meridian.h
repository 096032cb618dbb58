// Short loops to cut a surface's handles along.
#pragma once

#include <vector>

#include "surface/detail/topology/homology.h"

namespace innermap {

struct MeridianLoop {
  Loop loop;       // empty when there is none
  Integers cycle;  // its class
  double length = 0;
};

struct MeridianQuery {
  IntegerMatrix bounding;  // as many independent classes as handles, which do not cross one another
  IntegerMatrix taken;
  bool independent = true;    // no rational combination of `taken`; otherwise just none of them
  std::vector<char> blocked;  // #vertices
  double longest = 0;         // 0: any length
};

// The shortest loop along edges, through no vertex twice and through none that is blocked, whose
// class is not 0, is an integer combination of `bounding` and new after those `taken`.
//
// Shortest paths on the covering surface on which exactly those combinations close, from all
// vertices of the basis' loops, one of which every such loop meets (after Erickson and Whittlesey).
MeridianLoop shortestMeridian(const Points& vertices, const HalfEdges& edges,
                              const HomologyBasis& basis, const MeridianQuery& query);

}  // namespace innermap
