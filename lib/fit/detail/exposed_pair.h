// What bounds a solid, paired with where it goes, as proofs about its boundary take it.
#pragma once

#include "innermap/fit/boundary_pair.h"
#include "innermap/mesh/mesh.h"

namespace innermap {

// The exposed surface with corners of its own for each triangle, whose values may jump where two
// parts meet, and where these go.
struct ExposedPair {
  Mesh surface;
  Points targets;
};

ExposedPair exposedPair(const BoundaryPair& boundary);

}  // namespace innermap
