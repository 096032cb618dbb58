// The level set that settings of a whole job ask for.
#pragma once

#include "innermap/levelset/level_set.h"

namespace innermap {

// settings: of any job that has resolution and voxelSize as LevelSetSettings
// has them.
template <class Settings>
LevelSetSettings levelSetSettings(const Settings& settings) {
  LevelSetSettings out;
  out.resolution = settings.resolution;
  out.voxelSize = settings.voxelSize;
  return out;
}

}  // namespace innermap
