// Densities carried through a map without loss: the source's cells are mapped, and what they hold
// is put into the voxels that their images lie in.
#pragma once

#include <openvdb/openvdb.h>

#include <cstdint>
#include <limits>

#include "innermap/transfer/carry.h"
#include "transfer/detail/density_voxels.h"
#include "transfer/detail/extended_map.h"

namespace innermap {

struct CarryDensitySettings {
  int parts = 1;  // cells along each edge of a voxel of the source, at least 1
  double limit = std::numeric_limits<double>::infinity();  // of a density's growth, above 0
  bool constant = false;  // densities are constant in each voxel of the source, not linear
};

// A grid like the source's on the lattice of `region`, active there and where mass comes to; and
// the figures of it. Throws MemoryError (before allocating), Cancelled. Same result for any number
// of threads.
openvdb::GridBase::Ptr carryDensity(const DensityVoxels& source, const ExtendedMap& map,
                                    const openvdb::MaskGrid& region, CarriedMass& figures,
                                    const CarryDensitySettings& settings);

// Estimate of its peak need in bytes, for so many voxels of the source and of the target.
std::uint64_t densityMemory(std::uint64_t sourceVoxels, double targetVoxels);

}  // namespace innermap
