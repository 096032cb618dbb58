// Sets of points and what a harmonic map makes of them, by plain sums and intervals.
#pragma once

#include <array>

#include "innermap/field/harmonic_field.h"
#include "innermap/proof/prove.h"
#include "proof/detail/interval.h"

namespace innermap::proof {

// center + (convex hull of the vertices and their mirror images about the centre) + a ball of that
// radius. World units.
struct DirectSet {
  Vec3 center;
  std::array<Vec3, 4> vertex;
  double slack = 0;
};

// A cube, a little larger for what rounding does to its place.
DirectSet directSet(const ProofCell& cube);

// A step of a map takes the set to one that holds its image. determinant: unless null, of all
// determinants of the step's derivative on the set. False where nothing is known: a charge is too
// near.
bool throughStep(const HarmonicField& step, DirectSet& set, Interval* determinant);

// How many sets may be taken through the map for the cost of so many charges; one at least.
std::size_t mostParts(const ComposedMap& map, std::uint64_t charges);

}  // namespace innermap::proof
