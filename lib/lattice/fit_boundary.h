// The boundary of stuffed tetrahedra moved onto the solid's surface.
#pragma once

#include "innermap/levelset/solid.h"
#include "lattice/stuffing.h"

namespace innermap {

constexpr double kLeastDihedral = 10, kGreatestDihedral = 165;  // degrees

// Warped nodes are halved back to where they came from where a dihedral angle would leave
// kLeastDihedral to kGreatestDihedral.
void holdWarped(StuffedMesh& mesh);

// After holdWarped(). Vertices go to the closest surface points, halved back where a dihedral angle
// would leave kLeastDihedral to kGreatestDihedral.
void fitBoundary(const Solid& solid, double spacing, StuffedMesh& mesh);

// Vertices that were elsewhere `before` are halved back to there where a dihedral angle leaves the
// bounds, in degrees; before, all angles must have been within them. #V.
void boundVertices(const Points& before, double leastDihedral, double greatestDihedral,
                   StuffedMesh& mesh);

}  // namespace innermap
