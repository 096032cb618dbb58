// How fine grids are to be, as a person says it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "innermap/core/setting.h"

namespace innermap {

struct LatticeChoice {
  std::optional<int> resolution;    // without: that of the settings it goes into
  std::optional<double> voxelSize;  // world units; in place of the resolution

  // Any settings that have both.
  template <class Settings>
  Settings in(Settings settings = {}) const {
    settings.resolution = resolution.value_or(settings.resolution);
    settings.voxelSize = voxelSize.value_or(0);
    return settings;
  }
};

// of: what the resolution is along the longest side of. usual: what is taken without it; empty:
// what LevelSetSettings say.
std::vector<Setting> describe(LatticeChoice& choice, const std::string& of = "the solid",
                              const std::string& usual = "");

}  // namespace innermap
