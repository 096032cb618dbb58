// The surface at a given distance outside a solid.
#pragma once

#include "innermap/core/progress.h"
#include "innermap/levelset/solid.h"

namespace innermap {

struct OffsetSettings {
  double distance = 0.05;  // fraction of the solid's diagonal, in [1e-4, 2]
  Progress* progress = nullptr;
};

// Isosurface of the unsigned distance to solid.surface() at `distance`, the sheets inside the
// solid left out; triangles, world units, not closed in general where it was cut. Extracted from a
// grid with voxels of half the distance, at least 1/400 of the diagonal (but never coarser than
// the distance itself), then each vertex moved to the exact distance; vertices that cannot be
// (within 5%) are dropped with their triangles.
Mesh offsetSurface(const Solid& solid, const OffsetSettings& settings);

}  // namespace innermap
