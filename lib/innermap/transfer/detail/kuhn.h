// Kuhn's six tetrahedra of a cube, which fit together across the cubes of a lattice.
#pragma once

#include <array>
#include <cstddef>

namespace innermap {

// Corners (4 dx + 2 dy + dz) along the path from corner 0 to corner 7 that steps through the axes
// in each order; an odd order gives a tetrahedron that is turned the other way.
struct KuhnTetrahedron {
  std::array<std::size_t, 4> corner;
  bool odd;
};

inline constexpr std::array<KuhnTetrahedron, 6> kTetrahedra{{{{0, 4, 6, 7}, false},
                                                             {{0, 4, 5, 7}, true},
                                                             {{0, 2, 3, 7}, false},
                                                             {{0, 2, 6, 7}, true},
                                                             {{0, 1, 5, 7}, false},
                                                             {{0, 1, 3, 7}, true}}};

}  // namespace innermap
