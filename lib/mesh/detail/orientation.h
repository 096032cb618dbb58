// Consistent orientation of triangles, and the shells they form.
#pragma once

#include <cstddef>
#include <vector>

#include "innermap/mesh/mesh.h"
#include "mesh/detail/topology.h"

namespace innermap {

struct Orientation {
  std::vector<bool> turned;   // #T: whether the triangle must run the other way
  std::vector<int> shell;     // #T: numbers from 0, in order of their first triangles
  int shells = 0;             // parts that bound something together
  std::size_t conflicts = 0;  // edges where no orientation agrees (Moebius strips)
};

// Makes neighbours over edges of exactly two triangles agree, turning as little area as possible.
// Patches so oriented that meet in edges of three or more triangles are turned, the smaller against
// the larger, to balance those edges; they form one shell unless each is balanced by itself.
Orientation orient(const Points& vertices, const std::vector<Triangle>& triangles,
                   const std::vector<EdgeUse>& edges);

inline Triangle turnedIf(bool turn, Triangle t) {
  if (turn) std::swap(t[1], t[2]);
  return t;
}

}  // namespace innermap
