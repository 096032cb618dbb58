// Where exposed parts of a solid meet and do not move alike.
#pragma once

#include <vector>

#include "innermap/levelset/solid.h"

namespace innermap {

struct ValueJump {
  Vec3 place;       // on the solid's surface
  double size = 0;  // how far apart the values on both sides are, their units
};

// Places along the lines where triangles of the repaired mesh cross each other at the exposed
// surface, no farther apart than a five-hundredth of the diagonal, at which the values differ by
// more than `least`. values: at the vertices of solid.repaired().mesh, linear on triangles. Empty
// where nothing overlaps. Throws Cancelled.
std::vector<ValueJump> valueJumps(const Solid& solid, const Points& values, double least);

}  // namespace innermap
