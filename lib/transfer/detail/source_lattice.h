// The lattice through a source whose images start the inversion of its map.
#pragma once

#include <openvdb/openvdb.h>

#include <cstdint>

#include "innermap/levelset/solid.h"
#include "innermap/transfer/carry.h"
#include "innermap/transfer/inverse_map.h"

namespace innermap {

// Through the solid and a skin about it; with `outside`, also where the grids have active voxels
// within the distance, or anywhere when the map fades to a rigid motion. Throws SettingError,
// MemoryError, Cancelled.
SourceLattice makeSourceLattice(const Solid& solid, const OutsideSettings& outside,
                                const openvdb::GridPtrVec& grids);

// Adds all voxels around the solid up to `distance` (world units) from it to a region on the level
// set's lattice. Throws MemoryError when it takes more than memoryLimit().
void addAround(openvdb::MaskGrid& region, const Solid& solid, double distance,
               std::uint64_t bytesPerVoxel);

}  // namespace innermap
