// Whether a map is one-to-one, as far as points inside tell.
#pragma once

#include <functional>

#include "fit/target_shape.h"
#include "innermap/field/harmonic_field.h"
#include "innermap/fit/boundary_pair.h"
#include "innermap/fit/mapped_solid.h"

namespace innermap {

// Where points are wanted. Both may be called from any thread.
struct PointRegion {
  std::function<bool(const Vec3& p)> inside;
  // Whether the region's surface may be nearer than `distance`, world units.
  std::function<bool(const Vec3& p, double distance)> near;
};

// One random point in each cube of a lattice over the box, those inside, the same ones each time. A
// plate thinner than the step is met all through, as a lattice of points does not meet it. Cubes
// far from the region are left out in blocks: the work goes with the cubes in and about it, not
// with those of the box. step: world units. Throws Cancelled.
Points stratifiedPoints(const Box3& box, double step, const PointRegion& region);

// Those that lie inside the solid, about so many. Throws Cancelled.
Points pointsInside(const Solid& solid, std::size_t count);

// Images and Jacobian determinants of points.
struct MappedPoints {
  Points points;
  std::vector<double> determinants;
};

// Through one step: determinants are those of the whole way, if `before` has those of the way here.
// accuracy: of the sums, world units. Throws Cancelled.
MappedPoints mapPoints(const HarmonicMap& step, const MappedPoints& before, double accuracy);

// Through all steps.
MappedPoints mapPoints(const ComposedMap& map, Points points, double accuracy);

// Those of the whole way. error: the boundary's largest, world units.
DeterminantFigures determinantsOf(const MappedPoints& mapped, const TargetShape& target,
                                  double error);

// Share of the points whose determinant is not of that sign; see orientationOf().
double foldedShare(const std::vector<double>& determinants, int orientation);

// Share of the points that are outside the target by more than `slack`, world units; 0 of a target
// that bounds nothing. Throws Cancelled.
double outsideShare(const Points& points, const TargetShape& target, double slack);

}  // namespace innermap
