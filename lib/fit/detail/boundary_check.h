// What is known of a map's boundaries, and what it does at that of its solid: determinants there,
// and how often the image winds about points of the target.
#pragma once

#include <cstdint>

#include "fit/target_shape.h"
#include "innermap/field/harmonic_field.h"
#include "innermap/fit/mapped_solid.h"

namespace innermap {

// Before a map is looked at: of its boundaries.
Injectivity injectivityOf(const BoundaryPair& pair);

struct BoundaryCheckSettings {
  double error = 0;        // the boundary's largest, world units
  double accuracy = 1e-7;  // of the sums, world units
  std::uint64_t seed = 1;  // that of the fit
};

// At 10,000 of the points that the boundary's error is measured at. Charges stand outside, so the
// derivative there is that of the inside. Throws Cancelled.
DeterminantFigures boundaryDeterminants(const ComposedMap& map, const BoundaryPair& pair,
                                        const TargetShape& target,
                                        const BoundaryCheckSettings& settings);

// The image: triangles between the images of the vertices of the solid's surface, which is split
// where there are few and the map bends them by more than the error. About some 2,000 random
// points inside the target that are deeper than the error; about a target that is inside out
// winding is counted the other way round. Throws Cancelled.
DegreeFigures boundaryDegree(const ComposedMap& map, const BoundaryPair& pair,
                             const TargetShape& target, const BoundaryCheckSettings& settings);

// Adds both. error: that 99% of the boundary keep, fraction of the target's diagonal.
void checkBoundary(const ComposedMap& map, const BoundaryPair& pair, const TargetShape& target,
                   double error, std::uint64_t seed, Injectivity& known);

}  // namespace innermap
