// Where a target runs through itself: what lies there more than one part of the solid goes to, or
// none that is not turned over, whatever the map.
#pragma once

#include <optional>

#include "innermap/boundary/boundary_pair.h"
#include "innermap/mesh/detail/winding_number.h"
#include "innermap/mesh/triangle_tree.h"

namespace innermap {

// Safe from any number of threads.
class TargetOverlap {
 public:
  // error: the largest of the boundary, world units.
  TargetOverlap(const BoundaryPair& pair, double error);

  // Whether the target's surface winds about the point otherwise than once or not at all, or passes
  // through itself within a hundredth of the target's diagonal, and the error, of it. World units
  // of the target.
  bool at(const Vec3& p) const;

 private:
  double reach_ = 0;
  std::optional<TriangleTree> places_;
  std::optional<WindingNumber> winding_;
};

// The target's positions of the vertices of pair.solid().surface().
Points targetSurface(const BoundaryPair& pair);

}  // namespace innermap
