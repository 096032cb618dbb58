// Where a mesh runs through itself, along lines that show.
#pragma once

#include <array>
#include <vector>

#include "innermap/levelset/solid.h"

namespace innermap {

struct CrossingPoint {
  Vec3 place;
  std::array<SurfacePoint, 2> sides;  // addresses on repaired().mesh
};

// Points on the exposed surface, about `apart` (world units, positive) from one another along each
// line that two triangles share, at least one on each. Throws Cancelled.
std::vector<CrossingPoint> exposedCrossings(const Solid& solid, double apart);

}  // namespace innermap
