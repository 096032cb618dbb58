// Whether two triangles of a surface meet in more than what they share, by exact signs.
#pragma once

#include <array>
#include <cstdint>

#include "innermap/mesh/mesh.h"

namespace innermap {

enum class Meeting {
  apart,     // in corners and edges that they share, and nowhere else
  crossing,  // the inside of one passes through that of the other
  undecided  // they touch, lie on one another, or are degenerate
};

// Beside intersect_triangles.h, which looks for crossings worth telling: here what touches is not
// apart. Corners are shared where their numbers are equal, not where their places are.
// `exact` counts signs that took exact arithmetic.
Meeting meetingOf(const Points& vertices, const Triangle& a, const Triangle& b,
                  std::uint64_t& exact);

// The same for the segment from p to q, which shares nothing with the triangle.
Meeting meetingOf(const Vec3& p, const Vec3& q, const std::array<Vec3, 3>& t, std::uint64_t& exact);

}  // namespace innermap
