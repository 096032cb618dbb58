// A map in steps: through intermediate shapes, each step a harmonic map of the present one.
#pragma once

#include <optional>
#include <vector>

#include "innermap/field/fit.h"
#include "innermap/field/harmonic_field.h"
#include "innermap/fit/boundary_pair.h"
#include "innermap/fit/fit_map.h"
#include "innermap/fit/mapped_solid.h"

namespace innermap {

struct StepFitSettings {
  double tolerance = 2e-3;  // of the whole; fraction of the target's diagonal
  double folds = 0;         // share of the points inside that may be folded in the end, in [0, 1]
  // Steps that are proven to fold anywhere are halved too: ProofSettings::cellsPerCharge for that.
  std::optional<double> proofCells;
  int maxSteps = FitMapSettings().maxSteps;
  std::size_t maxSources = 100000;  // of one step
  // Of all fits of one way, those that are thrown away included, at the tolerance of surfaces that
  // were laid on one another, more in proportion at a smaller one; beyond them one step does the
  // rest. Ways that arrived took up to 320,000.
  double waySources = 400000;
  std::uint64_t seed = 1;
};

struct StepFit {
  ComposedMap map;
  std::vector<MapStep> steps;
  BoundaryError error;                 // of the whole, end to end
  AdaptiveEnd end = AdaptiveEnd::met;  // of the first step that did not reach its tolerance
};

// Each step starts from where the steps before it take the boundary, not from the shape that they
// were to reach: so nothing is ever outside the solid that a step is fitted on, and an error is
// handed on as it is, not magnified. Each step also brings points back that those before it left
// far from where they should be (through smoothed shapes the last one alone). A step that folds
// points inside is halved while there are fewer than maxSteps: where its first charges fold more
// than a quarter, or the whole fit more than half, of what is left of `folds`; or where cells are
// proven to fold, if that is asked for. Where intermediate shapes run through themselves the way
// goes through smoothed ones (shape_smoother.h), at once or when it is lost; where both are lost,
// one step does the rest of the first. inside: points of the source. Throws DataError, MemoryError,
// Cancelled.
StepFit fitInSteps(const BoundaryPair& pair, const Points& inside, const StepFitSettings& settings);

}  // namespace innermap
