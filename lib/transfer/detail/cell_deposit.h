// The images of cells of a source, and what these hold, put into the voxels of a target.
#pragma once

#include <array>
#include <cstdint>

#include "innermap/core/vec3.h"
#include "transfer/detail/voxel_sums.h"

namespace innermap {

// Corners as of Kuhn's cells (core/kuhn_cells.h). images: voxel (i, j, k) of the target
// spans [i, i + 1] and so on. densities: of the source, linear in each of Kuhn's tetrahedra.
struct CellImage {
  std::array<Vec3, 8> images;
  std::array<double, 8> densities;
};

struct DepositFigures {
  std::uint64_t cells = 0, kept = 0, turned = 0;  // with a tetrahedron of the same, the other hand
  double largestCompression = 0;                  // of a tetrahedron: its volume by its image's

  void add(const DepositFigures& other);
};

class CellDeposit {
 public:
  // sourceVolume: of a cell, targetVolume: of a voxel; world units.
  CellDeposit(double sourceVolume, double targetVolume)
      : sourceVolume_(sourceVolume), targetVolume_(targetVolume) {}

  // Exactly, but for images more than 64 voxels wide: those of a cell that a map tears apart beside
  // its charges, which go to the voxel in their middle. What is not finite goes nowhere.
  void add(const CellImage& cell, VoxelSums& sums, DepositFigures& figures) const;

 private:
  void count(const CellImage& cell, DepositFigures& figures) const;

  double sourceVolume_, targetVolume_;
};

}  // namespace innermap
