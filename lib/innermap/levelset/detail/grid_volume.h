// Volumes by level set.
#pragma once

#include "innermap/levelset/solid.h"

namespace innermap {

// Volume of the solid in world units cubed, from the fog of a level set `resolution` voxels along
// the longest side.
double gridVolume(const Solid& solid, int resolution);

}  // namespace innermap
