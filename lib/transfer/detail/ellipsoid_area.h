// The area of an ellipsoid.
#pragma once

#include "innermap/core/vec3.h"

namespace innermap {

// Natural logarithm of the area by those of the semi-axes, any finite ones, to about 1e-14. By
// Carlson's R_G: DLMF 19.33.2 and 19.21.10; "Numerical computation of real or complex elliptic
// integrals", 1995.
double logEllipsoidArea(const Vec3& logAxes);

}  // namespace innermap
