// Voxels whose images lie outside the target.
#pragma once

#include <openvdb/openvdb.h>

#include "fit/target_shape.h"

namespace innermap {

struct OutsideVoxelsSettings {
  double slack = 0;  // world units of the target: what is less far outside does not count
  Vec3 origin;       // that the map's positions are relative to
};

// Active at the voxels inside (levelSet < 0) whose position in `map` is outside the target by more
// than the slack: their distances from its surface, world units. Null where there are none, or the
// target bounds nothing. The whole of a block of voxels is inside with its middle, where no surface
// comes as near to that as the others' images. Throws Cancelled. The same for any number of
// threads.
openvdb::FloatGrid::Ptr outsideVoxels(const openvdb::Vec3fGrid& map,
                                      const openvdb::FloatGrid& levelSet, const TargetShape& target,
                                      const OutsideVoxelsSettings& settings);

}  // namespace innermap
