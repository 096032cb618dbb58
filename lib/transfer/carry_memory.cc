#include <algorithm>
#include <cmath>
#include <string>

#include "innermap/transfer/carry.h"
#include "innermap/transfer/push_pull.h"
#include "transfer/detail/carry_density.h"

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
  // lattice through the source that the starts come from, 128 voxels across at most, and what else
  // does not grow.
  constexpr double kInverted = 100, kLattice = 150e6, kAcross = 128, kOther = 10e6;
  // Leaves of 8^3 voxels are allocated whole, along the surface some 6 voxels to either side; two
  // are active.
  constexpr double kReach = 12, kSkin = 2;
  const double voxel = voxelSizeFor(solid, output),
               margin = 2 * outside.distance * solid.diagonal();
  const Vec3 extent = solid.box().extent();
  double volume = solid.volume();
  if (margin > 0) {
    // As far as the grids reach, which the map makes somewhat larger or smaller.
    double reached = 0;
    for (const openvdb::GridBase::Ptr& grid : grids) reached = std::max(reached, boxVolume(*grid));
    const double around = (extent.x + margin) * (extent.y + margin) * (extent.z + margin);
    volume = grids.empty() ? around : std::min(around, std::max(volume, 1.2 * reached));
  }
  const double area = solid.area() / (voxel * voxel), inside = volume / std::pow(voxel, 3);
  double bytesPerVoxel = 12.2 * kind.fields, density = 0;
  bool inverted = kind.fields > 0 || grids.empty();
  for (const openvdb::GridBase::Ptr& grid : grids) {
    bytesPerVoxel += bytesOf(*grid);
    if (kind.pushed && isDensity(*grid, carry))
      density = std::max(density, static_cast<double>(densityMemory(grid->activeVoxelCount(),
                                                                    inside + kSkin * area)));
    else
      inverted |= kind.pushed || grid->getVectorType() == openvdb::VEC_CONTRAVARIANT_ABSOLUTE;
  }
  const double across = std::max({extent.x, extent.y, extent.z}) / voxel / kAcross;
  // What is around the solid is in it too, in coarser voxels.
  const double lattice = across * across * across * (margin > 0 ? 4 * volume / solid.volume() : 1);
  const double inverse =
      inverted ? kInverted * (inside + kSkin * area) + kLattice * std::min(1.0, lattice) : 0;
  // Values and gradients of a field at all voxels at once, in double precision.
  constexpr double kField = 130;
  const double field = kind.fields > 0 ? kField * (inside + kSkin * area) : 0;
  // The level sets of both solids, and one made on the way.
  return 3 * levelSetMemory(solid, output) +
         static_cast<std::uint64_t>(kOther + std::max(inverse + field, density) +
                                    bytesPerVoxel * (inside + kReach * area));
}

// A block of 128 voxels along each side that is full.
std::uint64_t carryBlockMemory(const Solid& other, const openvdb::GridPtrVec& grids,
                               const CarrySettings& carry, bool pushed) {
  // Measured, bytes: of a voxel, what the inverse and its starts take; what the lattice through the
  // source takes; and what else does not grow. Of full blocks of a ball and a cube this was 4 to
  // 11% above the need.
  constexpr double kVoxels = 128.0 * 128 * 128, kInverted = 90, kLattice = 125e6, kOther = 25e6;
  // Voxels of the target that the images of a density's cells lie in, at most: cells are cut where
  // they are 1.75 times as large (push.cc).
  constexpr double kImages = 5.4 * kVoxels;
  double voxel = 8 + (pushed ? kInverted : 0);
  std::uint64_t kept = 0;  // copies that go on beyond the surface
  std::uint64_t density = 0;
  for (const openvdb::GridBase::Ptr& grid : grids) {
    if (pushed && isDensity(*grid, carry)) {
      density = densityMemory(static_cast<std::uint64_t>(kVoxels), kImages) +
                static_cast<std::uint64_t>(2 * sizeof(double) * kImages);
      kept += grid->activeVoxelCount() / 8;
      continue;
    }
    voxel += bytesOf(*grid);
    kept += grid->memUsage();
  }
  LevelSetSettings given;
  given.voxelSize = finestVoxel(grids);
  const auto block = static_cast<std::uint64_t>(kOther + (pushed ? kLattice : 0) + voxel * kVoxels);
  return kept + (pushed ? 0 : levelSetMemory(other, given)) + std::max(block, density);
}

}  // namespace innermap
