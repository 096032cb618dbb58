// What pushing and pulling grids need in memory.
#pragma once

#include <openvdb/openvdb.h>

#include <cstdint>

#include "innermap/levelset/level_set.h"
#include "innermap/levelset/solid.h"
#include "innermap/transfer/carry.h"
#include "innermap/transfer/outside.h"

namespace innermap {

// Which way, and how many fields of vectors are pushed beside (VolumePusher::push).
struct CarryKind {
  bool pushed = true;
  int fields = 0;
};

// Estimate of the need, in bytes, of pushing or pulling the grids, which are read already, to the
// voxels of a solid, those of makeLevelSet(solid, output). Only the distance of `outside` counts;
// of `carry`, which grids are densities.
std::uint64_t carryMemory(const Solid& solid, const openvdb::GridPtrVec& grids,
                          const LevelSetSettings& output, const OutsideSettings& outside = {},
                          const CarrySettings& carry = {}, const CarryKind& kind = {});

}  // namespace innermap
