// On which side of a plane a point lies: never by rounding.
#pragma once

#include <cstdint>

#include "innermap/core/vec3.h"

namespace innermap {

enum class Sign {
  negative = -1,
  zero = 0,
  positive = 1,
  undecided = 2  // numbers too large, or too far apart in size: see orientation()
};

// The other way round.
constexpr Sign opposite(Sign s) {
  return s == Sign::negative ? Sign::positive : s == Sign::positive ? Sign::negative : s;
}

// The sign of det(b - a, c - a, d - a), of the coordinates as they are: positive where a, b, c run
// counter-clockwise as d sees them from above (the plane's upper side), zero where all four lie in
// one plane. World units, any.
//
// A filter in double precision decides where the determinant is beyond what rounding can make of
// it; else it is expanded without any rounding. After Shewchuk, "Adaptive Precision Floating-Point
// Arithmetic and Fast Robust Geometric Predicates", 1997: bound A of orient3d, and expansions.
// `exact` is raised by one where it came to those. Undecided only where a coordinate is not finite
// or, where expansions are needed, one that is not 0 is below 2^-290 of the largest.
Sign orientation(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, std::uint64_t& exact);

// The sign of component `axis` of cross(b - a, c - a), likewise: how a, b, c turn in the plane of
// the other two axes.
Sign turn(const Vec3& a, const Vec3& b, const Vec3& c, int axis, std::uint64_t& exact);

}  // namespace innermap
