// The tetrahedra between neighbouring voxels: each cube of eight in six about its diagonal (Kuhn,
// "Some combinatorial lemmas in topology", 1960). Those of neighbouring cubes meet in whole faces.
#pragma once

#include <array>

namespace innermap {

// Corners of a cube by the bits x, y, z of their numbers, in an order that makes the volume
// positive. Each cell goes along three edges from the lowest corner to the highest.
using KuhnCell = std::array<int, 4>;

constexpr std::array<KuhnCell, 6> kKuhnCells{
    {{0, 1, 3, 7}, {0, 3, 2, 7}, {0, 2, 6, 7}, {0, 6, 4, 7}, {0, 4, 5, 7}, {0, 5, 1, 7}}};

// Coord: openvdb::Coord, for folders that see it.
template <typename Coord>
Coord cornerOf(const Coord& cube, int corner) {
  return cube.offsetBy(corner & 1, corner >> 1 & 1, corner >> 2 & 1);
}

}  // namespace innermap
