#include <cmath>

#include "innermap/lattice/cell_mesh.h"
#include "innermap/lattice/outer_surface.h"

namespace innermap {
namespace {

// Bytes: a node of the lattice; a square of a cell's side on the surface, its level set and where
// its vertices go.
constexpr double kNodeBytes = 12, kOuterBytes = 500;

}  // namespace

StuffingNeed stuffingNeed(const Solid& solid, double spacing) {
  const Vec3 e = solid.box().extent();
  const double cells = (e.x / spacing + 7) * (e.y / spacing + 7) * (e.z / spacing + 7);
  const double inner = solid.volume() / std::pow(spacing, 3);
  const double outer = solid.area() / std::pow(spacing, 2);
  // A cell's cube has twelve tetrahedra and two nodes; what the surface adds to both was measured:
  // 1.8 to 2.7 and 1.4 to 1.9 to a square of a cell's side.
  const double tetrahedra = 12 * inner + 2.8 * outer, vertices = 2 * inner + 2 * outer;
  const double bytes = cells * 2 * kNodeBytes + tetrahedra * sizeof(Tetrahedron) +
                       vertices * sizeof(Vec3) + outer * kOuterBytes;
  return {static_cast<std::size_t>(tetrahedra), static_cast<std::size_t>(vertices),
          static_cast<std::uint64_t>(bytes)};
}

}  // namespace innermap
