// Whether a loop in space is knotted.
#pragma once

#include "innermap/core/vec3.h"

namespace innermap {

// Of a closed polygon that does not meet itself. False is proven where the polygon can be shrunk to
// a triangle, corner by corner, without passing through itself (Koniaris and Muthukumar,
// "Knottedness in ring polymers", 1991). Of what is left otherwise, a non-trivial Alexander
// polynomial proves true; it is trivial for no knot of up to ten crossings but the unknot.
bool isKnotted(const Points& polygon);

}  // namespace innermap
