// Proofs looked at again in another way, on a random sample: intervals rounded outward, plain sums
// over all charges, winding numbers by solid angles one after the other. What was proven with trees
// of expansions must agree; a place where it does not shows a fault of one of the two.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "innermap/proof/prove.h"

namespace innermap::proof {

struct RecheckSettings {
  std::size_t cells = 64;            // that are drawn, and as many triangles
  std::size_t points = 256;          // of the solid, each of which has to lie in a cell
  std::uint64_t terms = 10'000'000;  // charges that are summed for each cell or triangle, at most
  std::uint64_t seed = 1;
};

struct Disagreement {
  Vec3 place;  // world units of the source
  std::string what;
};

struct Recheck {
  std::size_t drawn = 0;    // cells, or triangles
  std::size_t decided = 0;  // of these: bounded on all of it, as was proven
  std::size_t points = 0;   // that were looked up among the cells
  // Of cells: |det J| on those decided. Of triangles: the largest error seen, and none on those
  // decided is larger; fractions of the target's diagonal.
  double least = 0, greatest = 0;
  std::optional<Disagreement> disagreement;  // the first, if any
};

// proof: of that map and solid, with keepProven. Throws Cancelled.
Recheck recheckSense(const ComposedMap& map, const Mesh& solid, const SenseProof& proof,
                     const RecheckSettings& settings);

// bound: none of the surface's points is farther from its target, as was proven; fraction of the
// target's diagonal. Throws Cancelled.
Recheck recheckBoundary(const ComposedMap& map, const Mesh& surface, const Points& target,
                        double bound, const RecheckSettings& settings);

// The image of one point is that far from another at least, rounding taken off; 0 where nothing is
// known. World units of the target.
double sureDistance(const ComposedMap& map, const Vec3& point, const Vec3& other);

// |det J| at one point is that at most, rounding added; infinite where nothing is known.
double largestDeterminant(const ComposedMap& map, const Vec3& point);

}  // namespace innermap::proof
