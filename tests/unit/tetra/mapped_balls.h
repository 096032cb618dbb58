// Balls with maps, for the tests of meshes carried by them.
#pragma once

#include <cmath>

#include "field/affine_map.h"
#include "fit/test_pairs.h"
#include "innermap/fit/fit_map.h"
#include "innermap/fit/mapped_solid.h"

namespace innermap::test {

// The map is affine, and known.
inline MappedSolid affineBall() {
  const Mesh source = ball(3);
  return {affineMap(kAffine, kAffineShift),
          makeBoundaryPair(source, moved(source, [](const Vec3& p) { return affineMap(p); })),
          {},
          {}};
}

}  // namespace innermap::test
