// What the file of a map or a field says of its fit, written and read here alone.
#pragma once

#include <optional>

#include "innermap/field/boundary_error.h"
#include "innermap/field/facts.h"

namespace innermap {

struct FitFacts {
  BoundaryError error;                       // NaN and no samples where the file does not say
  std::optional<double> tolerance, reached;  // as ToleranceOutcome has them
  std::optional<bool> met;
};

// rms, p99, max and samples of the error; the tolerance.
Facts factsOf(const BoundaryError& error);
Facts factsOfTolerance(double wanted, std::optional<double> reached, bool met);

FitFacts fitFacts(const Facts& facts);

}  // namespace innermap
