// Tunnels through a solid whose mesh has none: where a dent is so deep that it comes out on the
// other side, turned inside out.
#pragma once

#include <cstddef>
#include <vector>

#include "innermap/levelset/solid.h"
#include "lattice/detail/simple_changes.h"

namespace innermap {

// Nodes outside `part` (without pockets) that close tunnels, of its handles beyond `handles`: those
// tunnels that run into a region turned inside out, and others that take fewer nodes to close than
// to cut open.
//
// A tunnel is closed where it is narrowest: the outside is grown anew from the lattice's sides by
// simple points, the nodes farthest from the part first, and what it cannot take lies across the
// tunnels. To cut and to close are dual; of handles that are not wanted the smaller change is made
// (as by Ju, Zhou, Hu, "Editing the topology of 3D models by sketching", SIGGRAPH 2007), but a cut
// beside a dent would open its wall from end to end.
//
// all: all parts; no tunnel is closed beside another part. order: of growWithHandles(), which cuts.
std::vector<std::size_t> tunnelsToClose(const Solid& solid, const LatticeSigns& signs,
                                        const Sides& part, const Sides& all, int handles,
                                        const std::vector<float>& order);

}  // namespace innermap
