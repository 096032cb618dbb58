// Which tetrahedron a point is in.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "innermap/core/vec3.h"
#include "innermap/lattice/cell_mesh.h"

namespace innermap {

struct CellPoint {
  int tetrahedron = -1;  // none when the mesh has none
  // Of its corners; sums to 1. In [0, 1] within; beyond where the point is in no tetrahedron and
  // the one that is nearest continues linearly.
  std::array<double, 4> barycentric{1, 0, 0, 0};
  double distance = 0;  // from the tetrahedron, world units; 0 within
};

// Immutable; copies share their data; safe from any number of threads.
class CellLocator {
 public:
  // Tetrahedra without positive volume are left out. Each must be valid (see validate).
  CellLocator(const Points& vertices, const std::vector<Tetrahedron>& tetrahedra);

  // In several, the lowest number; in none, the nearest tetrahedron, of those the lowest.
  CellPoint locate(const Vec3& p) const;

 private:
  struct Implementation;
  std::shared_ptr<const Implementation> implementation_;
};

// With barycentric coordinates in [0, 1]: a place within, near to a point that is in none.
CellPoint clamped(CellPoint point);

// What `values`, one of each vertex, are there, linearly.
Vec3 valueAt(const Points& values, const std::vector<Tetrahedron>& tetrahedra,
             const CellPoint& point);

}  // namespace innermap
