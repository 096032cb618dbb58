// Which voxels carry values: the solid's inside and a skin about it.
#pragma once

#include <openvdb/openvdb.h>

#include <cstdint>

namespace innermap {

struct RegionSettings {
  double skin = 2;                  // voxels outside the surface, from 0 to the band's half-width
  std::uint64_t bytesPerVoxel = 1;  // that the caller will need, at least 1
};

// All voxels whose signed distance is at most `skin` voxels, as leaf voxels (no active tiles).
// `levelSet`: class level set with a half-width of at least skin voxels. Throws SettingError when
// the band is narrower, MemoryError when whole leaves of `bytesPerVoxel` would pass memoryLimit(),
// Cancelled.
openvdb::MaskGrid::Ptr activeRegion(const openvdb::FloatGrid& levelSet,
                                    const RegionSettings& settings = {});

}  // namespace innermap
