// Options of `fit` and `map` that say how a map is fitted.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "command.h"
#include "innermap/fit/fit_map.h"

namespace innermap::tool {

struct FittingOptions : FitChoices {
  bool bestEffort = false;
  std::optional<double> sourceRatio, collocationRatio;  // per vertex of the source mesh
};

void addFittingOptions(Command& command, FittingOptions& options);

// What the options mean for a source of so many vertices. Throws SettingError for a tolerance that
// cannot be and for options that exclude each other.
FitMapSettings fitMapSettings(const FittingOptions& options, std::size_t vertices,
                              bool laidOn = false);

// Throws what fitMapSettings throws for any mesh, before one is read.
void checkFittingOptions(const FittingOptions& options);

// "fit 2000 charges to 8000 boundary points", for --dry-run.
std::string fittingPlan(const FitMapSettings& settings);

// The fit's part of a job and the proofs about it, for Context::expect. places: bentPlaces() or
// likelyPlaces(); laidOn: the source is laid onto a stranger, which mostly takes steps.
std::vector<JobPhase> fittingPhases(const FitMapSettings& settings, double places, bool laidOn);

}  // namespace innermap::tool
