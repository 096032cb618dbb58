// The boundary of stuffed tetrahedra moved onto the solid's surface.
#pragma once

#include "innermap/core/progress.h"
#include "innermap/levelset/solid.h"
#include "innermap/tetra/detail/stuffing.h"

namespace innermap {

constexpr double kLeastDihedral = 10, kGreatestDihedral = 165;  // degrees

// Vertices go to the closest surface points, halved back where a dihedral angle would leave
// kLeastDihedral to kGreatestDihedral.
void fitBoundary(const Solid& solid, double spacing, StuffedMesh& mesh, Progress* progress);

}  // namespace innermap
