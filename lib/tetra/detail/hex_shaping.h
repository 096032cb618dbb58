// Hexahedra carried into a solid, untangled and evened out with their boundary on its surface.
#pragma once

#include <cstdint>
#include <vector>

#include "innermap/mesh/mesh.h"
#include "innermap/tetra/hexahedralize.h"

namespace innermap {

struct HexShapingSettings {
  double goal = 0.4;  // least scaled Jacobian of a corner that is worked for, in (0, 1)
  int rounds = 16;    // of evening out, after untangling
  std::uint64_t seed = 1;
};

// Moves hexes.mesh.vertices, which a map carried. surface: the solid's boundary, closed, world
// units. onSurface: of each vertex of the skin, where on it that was carried; kept up to date.
//
// The energy of untangle.h on the tetrahedra at the corners. Vertices of the boundary are held by
// springs along the surface's normals, so that they slide; and points spread over the surface each
// pull at the face that is nearest to them, along the way to it, so that the boundary does not
// slide off limbs, and is drawn into edges. A spring holds at first with kStiffness times the
// energy of a cube, to a hexahedron's edge squared. Corners below the goal count more from round to
// round. Deterministic, the same for any number of threads. Throws Cancelled.
void shapeHexahedra(BlockHexahedra& hexes, const Mesh& surface,
                    std::vector<SurfacePoint>& onSurface, const HexShapingSettings& settings = {});

}  // namespace innermap
