// How a map is to be fitted, as a person says it: with what a program or a script was given.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "innermap/boundary/map_fit.h"
#include "innermap/core/setting.h"

namespace innermap {

// Placing a number of charges on one shell goes without a tolerance.
struct FitChoices {
  std::optional<double> tolerance;  // without: that of `fit`, or kLaidOnTolerance
  std::optional<std::size_t> sources, collocation;
  ShellSettings shell;  // but for its sources and collocation
  FitMapSettings fit;   // but for its tolerance and shell

  // The first of them that places a number of charges, as it is called; empty where none does.
  std::string placedBy() const;

  // laidOn: the source was laid onto the target. Throws SettingError where choices exclude one
  // another.
  FitMapSettings settings(bool laidOn) const;
};

std::vector<Setting> describe(FitChoices& choices);

}  // namespace innermap
