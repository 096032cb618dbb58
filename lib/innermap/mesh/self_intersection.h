// Pairs of triangles of one mesh that pass through each other.
#pragma once

#include <functional>
#include <vector>

#include "innermap/mesh/mesh.h"

namespace innermap {

struct Crossing {
  int first = 0, second = 0;  // triangles that intersect each other
  Vec3 place;                 // a point near the intersection, world units
};

// All pairs (first < second, sorted) of triangles that intersect in more than what they share:
// pairs with a common edge count only when folded flat onto each other (coplanar overlap), pairs
// with a common vertex when they intersect away from it, pairs with three common vertices never.
// Vertices are common when their positions are equal bit by bit. Touching in a point or along an
// edge without passing through may or may not be counted. Degenerate triangles are left out.
// Interval overlap method, Moller, "A Fast Triangle-Triangle Intersection Test" (1997), in double
// precision. Throws Cancelled.
std::vector<Crossing> selfIntersections(const Points& vertices,
                                        const std::vector<Triangle>& triangles);

// The same, one at a time in an order that is the same for any number of threads, for meshes whose
// crossings would not fit in memory.
void forEachSelfIntersection(const Points& vertices, const std::vector<Triangle>& triangles,
                             const std::function<void(const Crossing&)>& visit);

}  // namespace innermap
