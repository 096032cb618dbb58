// Surfaces moved along their normals; moving points to a given distance.
#pragma once

#include "innermap/core/progress.h"
#include "innermap/levelset/solid.h"

namespace innermap {

// solid.surface() cut to triangles with edges no longer than `edge`, its vertices moved by
// `distance` along their angle-weighted normals (both world units). Not checked against other
// parts of the surface.
Mesh displacedSurface(const Solid& solid, double distance, double edge, Progress* progress);

// Moves p away from or towards the closest points of solid.surface() until its distance is
// `distance` (world units), within 5%; false when it does not get there.
bool moveToDistance(const Solid& solid, double distance, Vec3& p);

}  // namespace innermap
