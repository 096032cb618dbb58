// Which voxels carry values: the solid's inside and a skin about it.
#pragma once

#include <openvdb/openvdb.h>

#include <cstdint>

#include "innermap/core/progress.h"

namespace innermap {

// All voxels whose signed distance is at most `skin` voxels, as leaf voxels (no active tiles).
// `levelSet`: class level set with a half-width of at least skin voxels. Throws SettingError when
// the band is narrower, MemoryError when the grid of `bytesPerVoxel` (over whole leaves) would pass
// maxMemory (bytes; 0: no limit).
openvdb::MaskGrid::Ptr activeRegion(const openvdb::FloatGrid& levelSet, double skin,
                                    std::uint64_t bytesPerVoxel, std::uint64_t maxMemory,
                                    Progress* progress = nullptr);

}  // namespace innermap
