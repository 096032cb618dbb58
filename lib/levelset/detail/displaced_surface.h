// Surfaces moved along their normals.
#pragma once

#include "innermap/levelset/solid.h"

namespace innermap {

// solid.surface() cut to triangles with edges no longer than `edge`, its vertices moved by
// `distance` along their angle-weighted normals (both world units). Not checked against other
// parts of the surface.
Mesh displacedSurface(const Solid& solid, double distance, double edge);

}  // namespace innermap
