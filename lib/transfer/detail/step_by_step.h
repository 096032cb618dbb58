// A map in steps inverted step by step, the last one first.
#pragma once

#include "innermap/field/harmonic_field.h"

namespace innermap {

// Targets that are worth it: where more are not inverted the map folds, and there is nothing to
// find.
constexpr std::size_t kMostStepByStep = 2000;

struct StepByStepSettings {
  double tolerance = 0;  // of each step, world units
};

// For each target q a point p with f(p) = q: each step is inverted by Newton's method, with steps
// halved while they do not help, from where the steps before it bring the start. Every step is
// nearer to the identity than the whole, so this finds points that Newton's method on the whole
// does not. By plain sums, for few points. starts: #targets; where a step is not inverted the start
// is returned. Throws Cancelled.
Points invertStepByStep(const ComposedMap& map, const Points& targets, const Points& starts,
                        const StepByStepSettings& settings);

}  // namespace innermap
