#include "innermap/field/boundary_error.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "innermap/core/error.h"

namespace innermap {

std::vector<double> boundaryErrors(const HarmonicField& field, const Points& points,
                                   const Matrix& values, double unit,
                                   const BoundaryErrorSettings& settings) {
  if (!(unit > 0)) throw SettingError("unit", "must be positive");
  if (values.rows() != points.size() || values.columns() != field.channels())
    throw DataError("boundary error: the values do not fit the points and channels");
  std::vector<double> lengths(points.size());
  if (points.empty()) return lengths;
  EvaluateFieldSettings evaluation;
  evaluation.accuracy = settings.accuracy;
  evaluation.progress = settings.progress;
  const Matrix got = field.evaluate(points, evaluation).values;
  for (std::size_t i = 0; i < points.size(); ++i) {
    double square = 0;
    for (std::size_t k = 0; k < values.columns(); ++k) {
      const double e = (got(i, k) - values(i, k)) / unit;
      square += e * e;
    }
    lengths[i] = std::sqrt(square);
  }
  return lengths;
}

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
  return out;
}

BoundaryError measureBoundaryError(const HarmonicField& field, const Points& points,
                                   const Matrix& values, double unit,
                                   const BoundaryErrorSettings& settings) {
  return summarizeErrors(boundaryErrors(field, points, values, unit, settings));
}

}  // namespace innermap
