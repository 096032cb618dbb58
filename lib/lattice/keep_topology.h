// The nodes inside a lattice made to have the solid's components, cavities and handles.
#pragma once

#include <cstddef>

#include "innermap/lattice/outer_surface.h"
#include "innermap/levelset/solid.h"
#include "lattice/lattice_signs.h"

namespace innermap {

struct KeptTopology {
  SolidTopology found;
  bool kept = false;        // found is `wanted`
  std::size_t changed = 0;  // nodes whose side is not what the distance says
  // Points of the surface, about half a spacing apart, and those that no node inside is near.
  std::size_t points = 0, lost = 0;
};

// Before warpNodes(). First the nodes in thin walls and narrow gaps get their sides; if that is not
// enough, the nodes are grown from a part of them with the right topology, deepest first, or
// thinned out of a thicker set, by nodes that change no topology ("simple points"; Bertrand,
// "Simple points, topological numbers and geodesic neighborhoods in cubic grids", 1994), whichever
// changes fewer. Where nothing helps the signs stay those of the distances. Without `wanted` only
// thin walls are seen to.
KeptTopology keepTopology(const Solid& solid, const SolidTopology* wanted, LatticeSigns& signs);

}  // namespace innermap
