// A map in steps: through intermediate shapes, each step a harmonic map of the present one.
#pragma once

#include <functional>
#include <vector>

#include "innermap/boundary/boundary_pair.h"
#include "innermap/boundary/detail/inside_check.h"
#include "innermap/boundary/mapped_solid.h"
#include "innermap/field/adaptive_fit.h"
#include "innermap/field/harmonic_map.h"

namespace innermap {

// The fit of one step.
struct FittedStep {
  HarmonicMap map;
  double diagonal = 0;                 // of its target, world units
  double error = 0;                    // at 99% of its boundary, fraction of that
  AdaptiveEnd end = AdaptiveEnd::met;  // why its tolerance was not met
};

struct StepFitSettings {
  // Of a step between two shapes of the same triangles. coarse: quick, for planning.
  std::function<FittedStep(const Mesh& from, const Mesh& to, bool coarse)> fit;
  int maxSteps = 16;
  Progress* progress = nullptr;
};

struct StepFit {
  ComposedMap map;
  std::vector<MapStep> steps;
  AdaptiveEnd end = AdaptiveEnd::met;  // of the first step that did not reach its tolerance
  StageSeconds seconds;                // "plan", "steps"
};

// The way is halved until, at a coarse fit, no step folds any point, or there are maxSteps;
// then each is fitted, and halved again where it folds. inside: points of the source. Throws what
// settings.fit throws.
StepFit fitInSteps(const BoundaryPair& pair, const Points& inside, const StepFitSettings& settings);

}  // namespace innermap
