// Sheets of a mesh that lie inside its solid, because the mesh runs through itself.
#pragma once

#include <vector>

#include "innermap/levelset/solid.h"
#include "lattice/lattice_signs.h"

namespace innermap {

// The order in which nodes are taken when the solid is grown again without handles that its mesh
// does not have, highest first: #nodes, meaningless where nothing is inside.
//
// Far from all sheets first. Along buried ones last, those of the largest connected patch before
// those of smaller ones: so where a limb pierces the body, the cut is the patch of the body's skin
// across the limb, where it enters, and not across the limb at its root. Patches buried no deeper
// than some three spacings, where parts touch, do not count: there the shallowest nodes come last.
// depth: #nodes, of depthsInside().
std::vector<float> growingOrder(const Solid& solid, const LatticeSigns& signs,
                                const std::vector<float>& depth);

}  // namespace innermap
