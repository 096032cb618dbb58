// The tetrahedra between neighbouring voxels: each cube of eight in six about its diagonal (Kuhn,
// "Some combinatorial lemmas in topology", 1960). Those of neighbouring cubes meet in whole faces.
#pragma once

#include <openvdb/openvdb.h>

#include <array>
#include <cstddef>

namespace innermap {

using KuhnCell = std::array<openvdb::Coord, 4>;

// Corners of a cube by the bits x, y, z of their numbers, in an order that makes the volumes
// positive.
constexpr std::array<std::array<int, 4>, 6> kKuhnCells{
    {{0, 1, 3, 7}, {0, 3, 2, 7}, {0, 2, 6, 7}, {0, 6, 4, 7}, {0, 4, 5, 7}, {0, 5, 1, 7}}};

inline openvdb::Coord cornerOf(const openvdb::Coord& cube, int bits) {
  return cube.offsetBy(bits & 1, bits >> 1 & 1, bits >> 2 & 1);
}

// Calls add(number of the cell, its corners) for each cell of a cube, named by its lowest corner,
// of which all corners are inside(corner).
template <class Inside, class Add>
void forKuhnCells(const openvdb::Coord& cube, const Inside& inside, const Add& add) {
  std::array<bool, 8> in;
  for (int bits = 0; bits < 8; ++bits)
    in[static_cast<std::size_t>(bits)] = inside(cornerOf(cube, bits));
  for (std::size_t k = 0; k < kKuhnCells.size(); ++k) {
    KuhnCell corners;
    bool all = true;
    for (std::size_t i = 0; i < 4; ++i) {
      all = all && in[static_cast<std::size_t>(kKuhnCells[k][i])];
      corners[i] = cornerOf(cube, kKuhnCells[k][i]);
    }
    if (all) add(k, corners);
  }
}

}  // namespace innermap
