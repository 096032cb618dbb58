// Values continued beyond a solid, as textures are padded at their borders.
#pragma once

#include <openvdb/openvdb.h>

namespace innermap {

// A copy of `grid`, of one of GridTypes but masks, whose inactive voxels outside the solid (or
// within a voxel of its surface) that are within `layers` voxels of active ones have the mean of
// their active neighbours (of the nearest for types without means). Voxels deeper inside keep what
// they hold: there the grid itself ends.
openvdb::GridBase::Ptr continuedBeyond(const openvdb::GridBase& grid,
                                       const openvdb::FloatGrid& solid, int layers);

// Goes on with the values of velocities, world units per second, around the active voxels as far as
// each goes in so many seconds: layer by layer, the mean of the active neighbours. Throws
// MemoryError, Cancelled.
void continueBySpeed(openvdb::Vec3SGrid& velocity, double seconds);

}  // namespace innermap
