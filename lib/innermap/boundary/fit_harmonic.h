// Harmonic fields of a solid from what is known on its surface: values on some of it, fluxes
// (derivatives along the outward normal) on the rest.
//
// The field is an affine function plus point charges outside the solid, as for maps (see
// fit_map.h), fitted to both kinds of conditions at once by least squares. A flux counts as the
// change of value that it makes on the way to the nearest place whose value is given: that is what
// an error of it comes to, and near the border of the two parts, where the field goes as the root
// of the distance and its flux grows without bound, it stays small. Charges are added where the
// error is, until 99% of the boundary lies within a tolerance.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "innermap/boundary/boundary_conditions.h"
#include "innermap/boundary/boundary_pair.h"
#include "innermap/core/setting.h"
#include "innermap/field/adaptive_fit.h"

namespace innermap {

struct HarmonicFitSettings {
  double tolerance = 1e-3;  // of the largest span of a channel's values
  std::size_t maxSources = 100000;
  std::uint64_t seed = 1;
};

std::vector<Setting> describe(HarmonicFitSettings& settings);

struct HarmonicFit {
  HarmonicField field;
  double span = 0;  // the largest of a channel's given values, their units
  // Fractions of the span, at 20,000 random points of the boundary that took no part in the fit and
  // where the largest error was looked for (see certify): of the values where they are given, and
  // elsewhere of the flux, times the distance to the nearest place whose value is given. Without
  // fluxes error.bound is how far the field can be off anywhere inside (maximum principle).
  BoundaryError error;
  // About the largest error of a value anywhere inside, fluxes included: the value that those
  // errors would give if they were all of one sign (comparison principle; Protter and Weinberger,
  // "Maximum Principles in Differential Equations", 1984, 2.6). Fraction of the span.
  double bound = 0;
  bool met = false;  // error.p99 is within the tolerance
  AdaptiveEnd end = AdaptiveEnd::met;
  double freeShare = 0;  // of the area where the flux is given
  std::size_t sources = 0, collocation = 0;
  std::vector<std::string> notes, warnings;
  StageSeconds seconds;  // "fit", "certificate"
};

// boundary: the mesh of the conditions (its `mesh` counts vertices and triangles). Surfaces that
// close its holes take the mean of their rim's values where no flux is given anywhere, and no flux
// else. Throws SettingError, DataError (sizes that do not fit, values that are not finite, no place
// with a value, no room for charges), MemoryError, Cancelled. Deterministic for a seed, whatever
// the number of threads.
HarmonicFit fitHarmonic(const SourceBoundary& boundary, const BoundaryConditions& conditions,
                        const HarmonicFitSettings& settings = {});

// The field whose channels sum up to 1 everywhere: what they lack is shared among them equally.
// Each stays harmonic, and moves by no more than the sum was off.
HarmonicField withUnitSum(const HarmonicField& field);

}  // namespace innermap
