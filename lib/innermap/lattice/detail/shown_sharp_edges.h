// Sharp edges of a mesh as far as its solid shows them.
#pragma once

#include "innermap/core/progress.h"
#include "innermap/lattice/detail/sharp_edges.h"
#include "innermap/levelset/solid.h"

namespace innermap {

// Of the repaired mesh, not of the solid's surface: that is in pieces where parts cross, and its
// edges are not whole there. Where a curve goes under the surface, it ends in a corner. angle:
// degrees; spacing: of the lattice, which follows no curve shorter than three of it. Throws
// Cancelled.
SharpEdges shownSharpEdges(const Solid& solid, double angle, double spacing, Progress* progress);

}  // namespace innermap
