#include <fmt/format.h>

#include "innermap/levelset/level_set.h"

namespace innermap {

std::vector<Setting> describe(LatticeChoice& c, const std::string& of, const std::string& usual) {
  return {Setting("resolution", "N", &c.resolution, "voxels along the longest side of " + of)
              .from(kLeastVoxels, kMostVoxels)
              .otherwise(usual.empty() ? fmt::format("{}, more for a thin solid", kUsualResolution)
                                       : usual),
          Setting("voxel_size", "LENGTH", &c.voxelSize, "edge of a voxel, in place of {resolution}")
              .in("world units")
              .above(0, 1e12)
              .otherwise("by {resolution}")};
}

}  // namespace innermap
