// The hierarchical layout of a torus whose periods are known.
#pragma once

#include "innermap/surface/correspond.h"

namespace innermap {

// shift: the periods that the corners of each triangle stand apart (layout.h). See torus_layout.h.
Layout relaxedTorus(const ClosedSurface& surface, const std::vector<CornerShifts>& shift);

// The triangles `alive` (all when empty) laid out by the harmonic map with equal weights: each
// vertex at the mean of its neighbours. The lattice is the unit square's.
Layout harmonicTorus(std::size_t vertices, const std::vector<Triangle>& triangles,
                     const std::vector<CornerShifts>& shift);

}  // namespace innermap
