// How far a field is from its boundary values at points that took no part in the fit. As the field
// is harmonic, the largest error on the boundary bounds the error everywhere inside.
#pragma once

#include <cstddef>
#include <vector>

#include "innermap/core/vec3.h"
#include "innermap/field/harmonic_field.h"
#include "innermap/solve/collocation.h"

namespace innermap {

struct BoundaryError {
  // Euclidean length of the error over all channels, divided by `unit`.
  double rms = 0, p99 = 0, max = 0;
  double sumOfSquares = 0;  // the paper's C-Error when taken at the collocation points
  std::size_t samples = 0;
  // With kCertificateConfidence: at least 99% of the boundary is within p99Bound, all of it within
  // bound; for uniform samples. See certify, whose `max` and `bound` are those of a search.
  double p99Bound = 0, bound = 0;
  std::size_t searched = 0;  // points beside `samples` at which the largest was looked for
  Vec3 maxAt;                // where it was met, world units of the source
  double missed = 0;         // share of the samples over the tolerance that certify was given
};

constexpr double kCertificateConfidence = 0.95;

// Fraction of the target's diagonal: a map whose error reaches it is not to be trusted.
constexpr double kDoubtfulError = 0.1;

struct BoundaryErrorSettings {
  double accuracy = 0;  // of the field's values, as HarmonicField::evaluate takes it; 0: plain sums
};

// The Euclidean length of the error over all channels at each point, divided by `unit`. Arguments
// and errors as below.
std::vector<double> boundaryErrors(const HarmonicField& field, const Collocation& at,
                                   const Matrix& values, double unit,
                                   const BoundaryErrorSettings& settings = {});

// Of the lengths at all points, which are taken for uniform ones. p99Bound and bound are infinite
// where these are too few for them.
BoundaryError summarizeErrors(std::vector<double> lengths);

// values: #points x #K. unit: usually the target's diagonal; must be positive.
// Throws DataError when sizes disagree, SettingError for a bad unit.
BoundaryError measureBoundaryError(const HarmonicField& field, const Collocation& at,
                                   const Matrix& values, double unit,
                                   const BoundaryErrorSettings& settings = {});

}  // namespace innermap
