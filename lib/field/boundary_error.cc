#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "innermap/core/error.h"
#include "innermap/field/fit.h"

namespace innermap {

std::vector<double> boundaryErrors(const HarmonicField& field, const Collocation& at,
                                   const Matrix& values, double unit,
                                   const BoundaryErrorSettings& settings) {
  if (!(unit > 0)) throw SettingError("unit", "must be positive");
  if (values.rows() != at.size() || values.columns() != field.channels())
    throw DataError("boundary error: the values do not fit the points and channels");
  std::vector<double> lengths(at.size());
  if (lengths.empty()) return lengths;
  EvaluateFieldSettings evaluation;
  evaluation.accuracy = settings.accuracy;
  Matrix got = field.evaluate(at.points, evaluation).values;
  const std::vector<std::size_t> derivatives = derivativeRows(at);
  if (!derivatives.empty()) {
    evaluation.gradients = true;
    const Points points = at.subset(derivatives).points;
    got = rowValues(at, std::move(got), field.evaluate(points, evaluation).gradients);
  }
  for (std::size_t i = 0; i < at.size(); ++i) {
    double square = 0;
    for (std::size_t k = 0; k < values.columns(); ++k) {
      const double e = (got(i, k) - values(i, k)) / unit;
      square += e * e;
    }
    lengths[i] = std::sqrt(square);
  }
  return lengths;
}

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Of lengths whose largest 1% stand last, in order. So many of n are within the quantile with the
// confidence: binomial, by the normal distribution, whose 95% are 1.645.
double quantileBound(const std::vector<double>& lengths) {
  const double n = static_cast<double>(lengths.size());
  const double rank = std::ceil(0.99 * n + 1.645 * std::sqrt(0.99 * 0.01 * n));
  return rank < n ? lengths[static_cast<std::size_t>(rank)] : kInfinity;
}

// About a peak of second order on a surface the area where the error falls short of it by less than
// t is proportional to t. So of the k largest the first falls short of the peak by a share of what
// the last does that is over 1 - (1 - confidence)^(1/(k-1)) in 1 - confidence of all cases. Where
// other peaks come in, or the peak is pointed, the share is larger: that of a pointed one, the
// root, is taken.
double largestBound(const std::vector<double>& lengths) {
  constexpr std::size_t kLargest = 10;
  const std::size_t n = lengths.size();
  if (n < 100 * kLargest) return kInfinity;
  const double first = lengths[n - 1], last = lengths[n - kLargest];
  const double share = std::sqrt(1 - std::pow(1 - kCertificateConfidence, 1.0 / (kLargest - 1)));
  return first + (first - last) * share / (1 - share);
}

}  // namespace

BoundaryError summarizeErrors(std::vector<double> lengths) {
  BoundaryError out;
  const std::size_t n = out.samples = lengths.size();
  if (n == 0) return out;
  for (const double e : lengths) out.sumOfSquares += e * e;
  out.rms = std::sqrt(out.sumOfSquares / static_cast<double>(n));
  out.max = *std::max_element(lengths.begin(), lengths.end());
  const std::size_t rank = std::min(n - 1, static_cast<std::size_t>(std::ceil(0.99 * n)) - 1);
  std::nth_element(lengths.begin(), lengths.begin() + rank, lengths.end());
  out.p99 = lengths[rank];
  std::sort(lengths.begin() + rank, lengths.end());
  out.p99Bound = quantileBound(lengths);
  out.bound = largestBound(lengths);
  return out;
}

BoundaryError measureBoundaryError(const HarmonicField& field, const Collocation& at,
                                   const Matrix& values, double unit,
                                   const BoundaryErrorSettings& settings) {
  return summarizeErrors(boundaryErrors(field, at, values, unit, settings));
}

}  // namespace innermap
