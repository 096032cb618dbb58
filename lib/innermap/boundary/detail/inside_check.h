// Whether a map is one-to-one, as far as points inside tell.
#pragma once

#include <cstdint>

#include "innermap/boundary/boundary_pair.h"
#include "innermap/field/harmonic_map.h"

namespace innermap {

// Points of a cubic lattice that lie inside the solid, about so many, in a fixed order. Throws
// Cancelled.
Points pointsInside(const Solid& solid, std::size_t count, Progress* progress = nullptr);

// Images and Jacobian determinants of points.
struct MappedPoints {
  Points points;
  std::vector<double> determinants;
};

// Through one step: determinants are those of the whole way, if `before` has those of the way here.
// accuracy: of the sums, world units. Throws Cancelled.
MappedPoints mapPoints(const HarmonicMap& step, const MappedPoints& before, double accuracy,
                       Progress* progress = nullptr);

// Share of the points whose determinant is not above 0.
double foldedShare(const std::vector<double>& determinants);

// Share of the points that are outside the solid by more than `slack`, world units. Throws
// Cancelled.
double outsideShare(const Points& points, const Solid& solid, double slack,
                    Progress* progress = nullptr);

}  // namespace innermap
