// What filling a solid with tetrahedra takes.
#pragma once

#include <cstddef>
#include <cstdint>

#include "innermap/levelset/solid.h"

namespace innermap {

// Estimates, from above by up to about a quarter.
struct StuffingNeed {
  std::size_t tetrahedra = 0, vertices = 0;
  std::uint64_t memory = 0;  // bytes, the peak beyond the solid
};

// spacing: of the lattice, world units, positive.
StuffingNeed stuffingNeed(const Solid& solid, double spacing);

}  // namespace innermap
