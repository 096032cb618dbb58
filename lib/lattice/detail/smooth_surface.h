// The surface of a lattice's inside without the lattice's teeth.
#pragma once

#include "innermap/levelset/solid.h"

namespace innermap {

// Where the vertices go when the surface is smoothed where it shows the lattice instead of the
// solid: at cuts, plugs and walls made thicker, which lie off the solid's surface, and along sharp
// edges where the mesh runs through itself, which the lattice breaks into teeth. There each vertex
// goes towards the mean of its neighbours, by less than `spacing` in all; the others stay. A map
// needs charges about as dense as the teeth: without them it takes half as many. spacing: of the
// lattice, world units.
Points smoothedWhereRough(const Solid& solid, double spacing, const Mesh& mesh);

}  // namespace innermap
