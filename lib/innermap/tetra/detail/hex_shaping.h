// Hexahedra carried into a solid, untangled and evened out with their boundary on its surface.
#pragma once

#include <cstddef>
#include <vector>

#include "innermap/core/progress.h"
#include "innermap/mesh/mesh.h"
#include "innermap/tetra/block_set.h"

namespace innermap {

struct HexShapingSettings {
  double goal = 0.35;  // least scaled Jacobian that is worked for
  int rounds = 30;     // at most, of evening out after untangling
  Progress* progress = nullptr;
};

struct HexShaping {
  int rounds = 0;       // of evening out
  double anchor = 0;    // weight that held the boundary where it was carried, energy by edge squared
};

// Moves hexes.mesh.vertices, where a map took them. surface: the solid's boundary, in world units.
// onSurface: where on it each vertex of the skin was carried, kept up to date. `core`: hexahedra
// that are not of the pillow layer, first in the list.
//
// The energy of untangle.h on the tetrahedra at the corners; vertices of the boundary are held by
// springs along the surface's normal where they are, and points of the surface pull at the faces
// below them, so that the boundary neither leaves the surface nor slides off its limbs. Corners
// below the goal count more from round to round. Deterministic. Throws Cancelled.
HexShaping shapeHexahedra(BlockHexahedra& hexes, std::size_t core, const Mesh& surface,
                          std::vector<SurfacePoint>& onSurface,
                          const HexShapingSettings& settings = {});

}  // namespace innermap
