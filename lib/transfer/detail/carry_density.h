// Densities carried through a map without loss: the source's cells are mapped, and what they hold
// is put into the voxels that their images lie in.
#pragma once

#include <openvdb/openvdb.h>

#include <cstdint>
#include <limits>
#include <map>

#include "innermap/transfer/carry.h"
#include "transfer/detail/cell_deposit.h"
#include "transfer/detail/density_voxels.h"
#include "transfer/detail/extended_map.h"
#include "transfer/detail/voxel_sums.h"

namespace innermap {

struct CarryDensitySettings {
  int parts = 1;  // cells along each edge of a voxel of the source, at least 1
  double limit = std::numeric_limits<double>::infinity();  // of a density's growth, above 0
  bool constant = false;  // densities are constant in each voxel of the source, not linear
};

// What cells of a source put into the voxels of a target.
struct DepositedDensity {
  VoxelSums sums;
  DepositFigures figures;

  void add(DepositedDensity more);
};

// Voxels are carried by cubes, at most 128 cells along each side: what memory the cells take does
// not grow with their number, and what a cube gives does not depend on who carries it. By its place
// among all cubes, how many of the voxels each has.
std::map<openvdb::Coord, std::uint64_t> densityCubes(const openvdb::MaskTree& voxels, int parts);

// What the carried voxels of a cube put where. target: of the voxels. Throws as carryDensity().
DepositedDensity carryDensityCube(const DensityVoxels& source, const ExtendedMap& map,
                                  const openvdb::math::Transform& target,
                                  const CarryDensitySettings& settings, const openvdb::Coord& cube);

// As carryDensity(), from what all cubes have put there, added in their order.
openvdb::GridBase::Ptr densityGrid(const DensityVoxels& source, const DepositedDensity& all,
                                   const openvdb::MaskGrid& region, CarriedMass& figures,
                                   const CarryDensitySettings& settings);

// A grid like the source's on the lattice of `region`, active there and where mass comes to; and
// the figures of it. Throws MemoryError (before allocating), Cancelled. Same result for any number
// of threads.
openvdb::GridBase::Ptr carryDensity(const DensityVoxels& source, const ExtendedMap& map,
                                    const openvdb::MaskGrid& region, CarriedMass& figures,
                                    const CarryDensitySettings& settings);

// Estimate of its peak need in bytes, for so many voxels of the source and of the target.
std::uint64_t densityMemory(std::uint64_t sourceVoxels, double targetVoxels);

}  // namespace innermap
