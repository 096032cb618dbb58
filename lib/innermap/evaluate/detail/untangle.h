// Tetrahedra that are inside out, turned right by moving their vertices.
//
// Garanzha, Kaporin, Kudryavtseva, Protais, Ray and Sokolov, "Foldover-free maps in 50 lines of
// code" (ACM TOG 40(4), 2021): an energy that is finite for folded elements too, and the more it
// rises there the nearer it comes to its end; minimised by L-BFGS (liblbfgs).
#pragma once

#include <array>
#include <vector>

#include "innermap/core/progress.h"
#include "innermap/core/vec3.h"

namespace innermap {

struct TetPatch {
  Points vertices;         // where they are now
  std::vector<char> free;  // may be moved; as many
  std::vector<std::array<int, 4>> tets;
  // Of each: J is the matrix of its edges from its first vertex, as columns, times this. Scaled so
  // that the determinants of J are about 1.
  std::vector<Mat3> rest;
};

Mat3 jacobianOf(const TetPatch& patch, std::size_t tet);

// Moves the free vertices. Returns the least determinant. Deterministic. Throws Cancelled.
double untangle(TetPatch& patch, Progress* progress = nullptr);

}  // namespace innermap
