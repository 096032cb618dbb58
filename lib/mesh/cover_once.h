// Whether the boundary of cells that are all right side out bounds them without overlaps.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "innermap/mesh/mesh.h"

namespace innermap {

struct CoverCheck {
  std::size_t crossings = 0;  // pairs of triangles that pass through each other
  std::size_t meetings = 0;   // pairs that touch or lie on one another, or may
  std::size_t doubled = 0;    // parts of the surface that wind otherwise than once just inside
  std::size_t unknown = 0;    // parts of which that is not known
  std::uint64_t exact = 0;    // signs that took exact arithmetic

  // Some places are inside of two cells.
  bool overlaps() const { return crossings + doubled > 0; }
  // No place is inside of two cells.
  bool once() const { return crossings + meetings + doubled + unknown == 0; }
};

// triangles: all faces of one cell alone, seen from outside counter-clockwise; each other face must
// belong to two cells, one on either side, and all cells must be right side out. Then as many cells
// lie about a point as the surface winds about it (the degree argument: Lipman, "Bijective Mappings
// of Meshes with Boundary and the Degree in Mesh Processing", SIAM J. Imaging Sciences 7(2), 2014),
// so no two overlap where its triangles meet in shared corners and edges alone, and it winds once
// about a point just inside each of its parts. A part is what hangs together by edges of two
// triangles: along those the winding does not change.
//
// All by exact signs of the coordinates as they are (core/orientation.h): what is not shown is not
// said. The surface may touch itself in shared corners and edges. The same for any number of
// threads. Throws Cancelled.
CoverCheck checkCover(const Points& vertices, const std::vector<Triangle>& triangles);

}  // namespace innermap
