#include "solve/detail/sum_reference.h"

#include <algorithm>
#include <cmath>

namespace innermap {
namespace {

constexpr double kGradientErrors = 100;  // their error may be so many times that of the values
// Where an absolute accuracy allows more: gradients still count.
constexpr double kLoosest = 1e-3;
// Of the magnitudes: the root mean square of what sums of any kind lose; measured 4e-17 with 60,000
// charges.
constexpr double kRounding = 2e-16;

double rootMeanSquare(const double* values, std::size_t count) {
  double sum = 0;
  for (std::size_t i = 0; i < count; ++i) sum += values[i] * values[i];
  return std::sqrt(sum / static_cast<double>(std::max<std::size_t>(count, 1)));
}

double rmsError(const Matrix& got, const Matrix& exact, std::size_t first, std::size_t columns) {
  const std::size_t count = columns * exact.rows();
  std::vector<double> error(count);
  for (std::size_t i = 0; i < count; ++i) error[i] = got.column(first)[i] - exact.column(first)[i];
  return rootMeanSquare(error.data(), count);
}

// Of the error in consecutive columns to what they hold.
double ratio(const Matrix& got, const Matrix& exact, std::size_t first, std::size_t columns) {
  const std::size_t count = columns * exact.rows();
  const double size = rmsError(got, exact, first, columns);
  return size > 0 ? size / rootMeanSquare(exact.column(first), count) : 0;
}

}  // namespace

SumReference::SumReference(FieldSamples exact, const FieldSamples& magnitudes, double accuracy,
                           double absolute)
    : exact_(std::move(exact)),
      relative_(exact_.values.columns(), accuracy),
      magnification_(relative_.size(), 1) {
  const std::size_t count = exact_.values.rows();
  for (std::size_t k = 0; k < relative_.size(); ++k) {
    const double size = rootMeanSquare(exact_.values.column(k), count);
    if (!(size > 0)) continue;
    relative_[k] = std::clamp(absolute / size, relative_[k], std::max(relative_[k], kLoosest));
    magnification_[k] = rootMeanSquare(magnitudes.values.column(k), count) / size;
  }
}

double SumReference::accuracy() const {
  double least = 1;
  for (std::size_t k = 0; k < relative_.size(); ++k)
    least = std::min(least, relative_[k] / magnification_[k]);
  return std::max(least, kRounding);
}

double SumReference::error(const FieldSamples& got) const {
  double worst = 0;
  for (std::size_t k = 0; k < relative_.size(); ++k)
    worst = std::max(worst, rmsError(got.values, exact_.values, k, 1));
  return worst;
}

double SumReference::excess(const FieldSamples& got) const {
  double worst = 0;
  for (std::size_t k = 0; k < relative_.size(); ++k) {
    worst = std::max(worst, ratio(got.values, exact_.values, k, 1) /
                                std::max(relative_[k], kRounding * magnification_[k]));
    if (!exact_.gradients.empty())
      worst = std::max(worst, ratio(got.gradients, exact_.gradients, 3 * k, 3) /
                                  (kGradientErrors * relative_[k]));
  }
  return worst;
}

}  // namespace innermap
