// leastJacobian(), counting.
#pragma once

#include <cstdint>

#include "innermap/tetra/hexahedralize.h"

namespace innermap {

// exact: raised by the number of corners whose signs took exact arithmetic.
JacobianBounds leastJacobian(const Points& vertices, const Hexahedron& cell, int halvings,
                             std::uint64_t& exact);

}  // namespace innermap
