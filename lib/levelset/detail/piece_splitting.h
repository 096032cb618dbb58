// Triangles cut into pieces along what passes through them.
#pragma once

#include <array>
#include <vector>

#include "innermap/core/vec3.h"
#include "mesh/winding_number.h"

namespace innermap {

using PieceCorners = std::array<std::array<double, 3>, 3>;  // barycentric, on the parent

// What lies on the two sides of a piece of surface.
struct Side {
  bool exposed = true;    // just one side has winding number over one half
  bool reversed = false;  // and it is the side the normal points to
  bool negative = false;  // one side has winding number below 0, none above
  int covers = 1;         // jump of the winding number across the piece

  friend bool operator==(const Side& x, const Side& y) {
    return x.exposed == y.exposed && x.reversed == y.reversed && x.negative == y.negative &&
           x.covers == y.covers;
  }
};

struct Piece {
  PieceCorners corners{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  Side side;
};

// Winding numbers a little to either side of the centroid. `diagonal` is the mesh's.
Side classify(const WindingNumber& winding, const std::array<Vec3, 3>& triangle, double diagonal);

std::array<Vec3, 3> pieceTriangle(const std::array<Vec3, 3>& parent, const Piece& piece);

// Halves the triangle at its longest edge, again and again, until each piece is free of `others`,
// or lies within one of its plane, or is no longer than `length`. Stops early, with a useless
// result, when there are more than `limit` pieces.
std::vector<Piece> splitTriangle(const std::array<Vec3, 3>& triangle,
                                 const std::vector<std::array<Vec3, 3>>& others, double length,
                                 double tolerance, std::size_t limit);

}  // namespace innermap
