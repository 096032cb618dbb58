// Voxels near line segments: how much of a solid lies along a seam.
#pragma once

#include <openvdb/openvdb.h>

#include <vector>

#include "innermap/core/vec3.h"

namespace innermap {

struct Segment {
  Vec3 from, to;  // world units

  double distance(const Vec3& p) const;
};

// The voxels inside the solid of `levelSet` whose centres are no farther than `reach` (world units,
// positive) from a segment. Throws SettingError, Cancelled.
openvdb::MaskGrid::Ptr voxelsNear(const std::vector<Segment>& segments,
                                  const openvdb::FloatGrid& levelSet, double reach);

}  // namespace innermap
