#include "innermap/transfer/carry_memory.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "innermap/transfer/detail/carrier.h"
#include "innermap/transfer/detail/carry_density.h"

namespace innermap {

namespace {

// Of a voxel, with its mask.
double bytesOf(const openvdb::GridBase& grid) {
  const std::string type = grid.valueType();
  if (type == "vec3d") return 24.2;
  return type.rfind("vec3", 0) == 0 ? 12.2 : type == "double" || type == "int64" ? 8.2 : 4.2;
}

double boxVolume(const openvdb::GridBase& grid) {
  const openvdb::Coord size = grid.evalActiveVoxelDim();
  const openvdb::Vec3d voxel = grid.voxelSize();
  return size.x() * voxel.x() * size.y() * voxel.y() * size.z() * voxel.z();
}

}  // namespace

std::uint64_t carryMemory(const Solid& solid, const openvdb::GridPtrVec& grids,
                          const LevelSetSettings& output, const OutsideSettings& outside,
                          const CarrySettings& carry, const CarryKind& kind) {
  // Measured, bytes: sources and Jacobians of the inverse and its starts, an active voxel; the
  // lattice through the source that the starts come from, and what else does not grow.
  constexpr double kInverted = 110, kLattice = 60e6;
  // Leaves of 8^3 voxels are allocated whole, along the surface some 6 voxels to either side; two
  // are active.
  constexpr double kReach = 12, kSkin = 2;
  const double voxel = voxelSizeFor(solid, output),
               margin = 2 * outside.distance * solid.diagonal();
  double volume = solid.volume();
  if (margin > 0) {
    // As far as the grids reach, which the map makes somewhat larger or smaller.
    const Vec3 extent = solid.box().extent();
    double reached = 0;
    for (const openvdb::GridBase::Ptr& grid : grids) reached = std::max(reached, boxVolume(*grid));
    const double around = (extent.x + margin) * (extent.y + margin) * (extent.z + margin);
    volume = grids.empty() ? around : std::min(around, volume + 1.5 * reached);
  }
  const double area = solid.area() / (voxel * voxel), inside = volume / std::pow(voxel, 3);
  double bytesPerVoxel = 12.2 * kind.fields, density = 0;
  bool inverted = kind.fields > 0;
  for (const openvdb::GridBase::Ptr& grid : grids) {
    bytesPerVoxel += bytesOf(*grid);
    if (kind.pushed && isDensity(*grid, carry))
      density = std::max(density, static_cast<double>(densityMemory(grid->activeVoxelCount(),
                                                                    inside + kSkin * area)));
    else
      inverted = kind.pushed;
  }
  const double inverse = inverted ? kInverted * (inside + kSkin * area) : 0;
  // One level set of the output; one for the fog or the distances made on the way.
  return 2 * levelSetMemory(solid, output) +
         static_cast<std::uint64_t>(kLattice + std::max(inverse, density) +
                                    bytesPerVoxel * (inside + kReach * area));
}

}  // namespace innermap
