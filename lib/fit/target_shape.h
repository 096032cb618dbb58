// A target as the images of points see it: what is inside, what is near its surface, and where it
// runs through itself.
#pragma once

#include <optional>

#include "innermap/fit/boundary_pair.h"
#include "mesh/triangle_tree.h"
#include "mesh/winding_number.h"

namespace innermap {

// -1 where the target is inside out, as a mirror's image, 1 otherwise: the sign that det J has
// wherever the map is not folded.
int orientationOf(const Solid& source, const TargetBoundary& target);

// World units of the target. Safe from any number of threads.
class TargetShape {
 public:
  explicit TargetShape(const BoundaryPair& pair);
  // Where the target runs through itself is not asked of it.
  TargetShape(const Solid& source, const TargetBoundary& target);

  // Mirrored targets have an inside too; those that bound nothing have none.
  bool inside(const Vec3& p) const;

  // Whether the surface is nearer than `distance`, parts of it that lie inside others included.
  bool near(const Vec3& p, double distance) const;

  double distance(const Vec3& p) const;  // from that surface, world units

  // What is there more than one part of the solid goes to, or none that is not turned over,
  // whatever the map: the surface winds about the point otherwise than once or not at all, or
  // passes through itself within a hundredth of the target's diagonal, and the boundary's error,
  // of it. Never where no triangles of the target cross.
  bool runsThroughItself(const Vec3& p, double error) const;

  double volume() const { return volume_; }         // world units cubed; 0 when parts cancel
  int orientation() const { return orientation_; }  // orientationOf()

 private:
  int orientation_ = 1;
  double volume_ = 0, reach_ = 0;
  TriangleTree tree_;  // of all of the target's triangles
  WindingNumber winding_;
  std::optional<TriangleTree> crossings_;
  std::optional<WindingNumber> exposed_;  // of what bounds the source, where that is not all
};

// The target's positions of the vertices of pair.solid().surface().
Points targetSurface(const BoundaryPair& pair);

}  // namespace innermap
