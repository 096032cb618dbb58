// The surface at a given distance outside a solid.
#pragma once

#include <functional>

#include "innermap/levelset/solid.h"

namespace innermap {

struct OffsetSettings {
  double distance = 0.05;  // fraction of the solid's diagonal, in [1e-4, 2]
};

// Surface of the points outside the solid at `distance` from solid.surface(); triangles, oriented
// outward, world units, not closed in general where it was cut. Each vertex is at the exact
// distance (those that cannot be brought within 5% of it are dropped with their triangles).
//
// Down to a distance of 1/400: isosurface of the unsigned distance on a grid with voxels of half
// the distance, at least 1/400 and at most 1/16 of the diagonal, the sheets inside the solid left
// out. Below that a grid would be too large, and the surface itself, cut to triangles of 1/150, is
// moved out along its normals.
Mesh offsetSurface(const Solid& solid, const OffsetSettings& settings);

// Whether any point of solid.surface() is nearer to p than that (world units): cheaper than which
// one is the closest.
bool isNearer(const Solid& solid, const Vec3& p, double than);

// Whether to go on at p, which was moved along the line through its closest point.
using Worthwhile = std::function<bool(const Vec3& p, const Solid::Closest& closest)>;

// Moves p away from or towards the closest points of solid.surface() until its distance is
// `distance` (world units), at most the share `enough` of it nearer; returns by how much it may
// still differ (in a crease between parts there may be no such point nearby). Gives up, and returns
// infinity, once it is not worthwhile.
double moveToDistance(const Solid& solid, double distance, Vec3& p, double enough = 1e-9,
                      const Worthwhile& worthwhile = {});

}  // namespace innermap
