// Cuts between parts of a solid that meet: what was not taken when it was grown again.
#pragma once

#include <cstddef>
#include <vector>

#include "innermap/core/vec3.h"
#include "lattice/detail/simple_changes.h"

namespace innermap {

// The nodes that are inside in `all`, and no longer in signs.side.
std::vector<std::size_t> cutNodes(const Sides& all, const LatticeSigns& signs);

// Of each piece of nodes that hangs together, the largest first: the box of its nodes, world units.
std::vector<Box3> boxesOf(const std::vector<std::size_t>& of, const LatticeSigns& signs);

// Sets sides and distances so that the cuts stand open: narrow where they come to the surface, and
// wider by as much as they lie deep. A boundary's values jump from one wall of a cut to the other;
// a harmonic map needs charges about as dense as the cut is narrow. Topology is kept. depth:
// #nodes, of depthsInside(), with the nodes of the cut inside.
void openCuts(const std::vector<std::size_t>& cut, const std::vector<float>& depth,
              LatticeSigns& signs);

// Likewise sets them so that what closes tunnels is as thick as an open cut is wide at its mouth:
// thicker plugs hide more of the mesh, and maps are no better. keptOut: nodes that stay outside,
// those of cuts.
void thickenPlugs(const std::vector<std::size_t>& plugs, const std::vector<std::size_t>& keptOut,
                  LatticeSigns& signs);

}  // namespace innermap
