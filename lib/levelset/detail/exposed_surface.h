// Which parts of a repaired mesh bound the solid of winding number over one
// half, and which are buried in other parts or doubled. What Solid is made with.
#pragma once

#include <vector>

#include "innermap/mesh/mesh.h"
#include "levelset/detail/piece_splitting.h"
#include "mesh/winding_number.h"

namespace innermap {

struct ExposedSurface {
  bool whole = true;  // all of the mesh is exposed: the rest is empty
  Mesh mesh;          // pieces, outward; vertices of the input first
  std::vector<int> parent;
  std::vector<PieceCorners> corners;
  double gap = 0;            // longest edge of a piece that a cut runs through, world units
  double doubledArea = 0;    // of sheets kept although another lies on them, world units squared
  double negativeShare = 0;  // of the mesh's area: bounds regions of winding number below 0
  // Of the mesh about its box's center, where points next to its triangles keep their digits.
  WindingNumber winding;
  Vec3 center;
};

// `mesh` has whole winding numbers, as repair() makes them. pieceSize is a fraction of the
// diagonal. Throws DataError when nothing is exposed; Cancelled.
ExposedSurface exposedSurface(const Mesh& mesh, double pieceSize);

}  // namespace innermap
