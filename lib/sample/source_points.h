// Where the charges stand.
#pragma once

#include <cstdint>

#include "innermap/core/vec3.h"
#include "innermap/levelset/solid.h"

namespace innermap {

struct SourceSettings {
  std::size_t count = 2000;  // in [1, 1e7]
  std::uint64_t seed = 1;
};

// Blue noise on the offset surface at `distance` (fraction of the solid's diagonal, in [1e-4, 2];
// the paper's O-Distance). Every point is outside the solid and no nearer than 0.9 of the distance
// to it, which is checked point by point. Exactly settings.count points.
Points sourceShell(const Solid& solid, double distance, const SourceSettings& settings = {});

// Blue noise on the sphere about the box's centre whose radius is `ratio` times half the diagonal
// (the paper's R-Ratio), in (1, 100].
Points sourceSphere(const Solid& solid, double ratio, const SourceSettings& settings = {});

}  // namespace innermap
