#include "innermap/transfer/carry_memory.h"

#include <algorithm>
#include <cmath>

#include "innermap/transfer/detail/carrier.h"
#include "innermap/transfer/detail/carry_density.h"

namespace innermap {

std::uint64_t carryMemory(const Solid& solid, const openvdb::GridPtrVec& grids,
                          const LevelSetSettings& output, const OutsideSettings& outside,
                          const CarrySettings& carry) {
  const double voxel = voxelSizeFor(solid, output);
  // Sources and Jacobians of the inverse and its starts, 100 bytes a voxel; leaves of 8^3 voxels
  // are allocated whole, along the surface some 6 voxels to either side. Around it, the space is
  // taken as full.
  const double margin = 2 * outside.distance * solid.diagonal();
  const Vec3 extent = solid.box().extent();
  double volume = solid.volume();
  if (margin > 0) volume = (extent.x + margin) * (extent.y + margin) * (extent.z + margin);
  const double voxels = volume / std::pow(voxel, 3) + 12 * solid.area() / (voxel * voxel);
  std::uint64_t bytesPerVoxel = 100, inputs = 0, density = 0;
  for (const openvdb::GridBase::Ptr& grid : grids) {
    if (isDensity(*grid, carry))
      density = std::max(density, densityMemory(grid->activeVoxelCount(), voxels));
    bytesPerVoxel += grid->valueType() == "vec3d" ? 24 : 12;
    inputs += 2 * grid->memUsage();
  }
  constexpr std::uint64_t kLattice = 150'000'000;
  return levelSetMemory(solid, output) + inputs + kLattice + density +
         static_cast<std::uint64_t>(static_cast<double>(bytesPerVoxel) * voxels);
}

}  // namespace innermap
