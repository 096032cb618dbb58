// The level set that settings of a whole job ask for.
#pragma once

#include "innermap/levelset/level_set.h"

namespace innermap {

// Of the solid's box, world units.
double longestSide(const Solid& solid);

// settings: of any job that has resolution and voxelSize as LevelSetSettings has them.
template <class Settings>
LevelSetSettings levelSetSettings(const Settings& settings) {
  LevelSetSettings out;
  out.resolution = settings.resolution;
  out.voxelSize = settings.voxelSize;
  return out;
}

// makeLevelSet() of one block of voxels, as voxelBlocks() has them: its values, and all else is
// outside.
openvdb::FloatGrid::Ptr makeLevelSetBlock(const Solid& solid, const LevelSetSettings& settings,
                                          const openvdb::Coord& block);

}  // namespace innermap
