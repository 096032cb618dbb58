// Pairs of triangles that pass through each other, for callers that have a tree of them already.
#pragma once

#include <functional>
#include <vector>

#include "innermap/mesh/check.h"
#include "mesh/triangle_tree.h"

namespace innermap {

// forEachSelfIntersection() of check.h; the tree was made of those vertices and triangles.
void forEachSelfIntersection(const TriangleTree& tree, const Points& vertices,
                             const std::vector<Triangle>& triangles,
                             const std::function<void(const Crossing&)>& visit);

}  // namespace innermap
