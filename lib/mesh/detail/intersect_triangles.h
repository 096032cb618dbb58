// Whether two triangles pass through each other.
#pragma once

#include <array>

#include "innermap/core/vec3.h"

namespace innermap {

using TriangleCorners = std::array<Vec3, 3>;

// Whether the triangles intersect in more than corners and edges that they share (corners are
// shared when they are equal bit by bit). `place` receives a point of the intersection.
//
// Which side of a plane a corner is on is decided with Shewchuk's error bound: what rounding could
// turn counts as on the plane. Coordinates should be of about unit size.
bool passThrough(const TriangleCorners& a, const TriangleCorners& b, Vec3& place);

}  // namespace innermap
