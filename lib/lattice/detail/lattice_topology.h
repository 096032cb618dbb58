// Components, cavities and handles of what is inside a lattice.
#pragma once

#include "innermap/lattice/outer_surface.h"
#include "lattice/lattice_signs.h"

namespace innermap {

// Of the nodes inside, neighbours joined: what stuffed() makes of them has just these. Nodes moved
// onto the surface count as outside.
SolidTopology latticeTopology(const LatticeSigns& signs);

}  // namespace innermap
