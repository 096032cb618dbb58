#include "innermap/field/harmonic_field.h"

#include <algorithm>
#include <cmath>

#include "innermap/core/error.h"

namespace innermap {

struct HarmonicField::Data {
  Points sources;
  Matrix weights;
  Affine affine;
  FastSum sum;
};

namespace {

void addAffine(const Affine& affine, const Points& points, FieldSamples& out) {
  for (std::size_t k = 0; k < out.values.columns(); ++k)
    for (std::size_t i = 0; i < points.size(); ++i) {
      out.values(i, k) += affine.value(points[i], k);
      for (std::size_t a = 0; !out.gradients.empty() && a < 3; ++a)
        out.gradients(i, 3 * k + a) += affine.coefficients(1 + a, k);
    }
}

FastSumSettings sumSettings(const EvaluateFieldSettings& settings) {
  if (!(settings.accuracy >= 0))
    throw SettingError("accuracy", "of a field's values must not be negative");
  FastSumSettings sums;
  sums.accuracy = 1e-12;
  sums.absolute = settings.accuracy;
  sums.gradients = settings.gradients;
  if (settings.accuracy == 0) sums.method = SumMethod::direct;
  return sums;
}

}  // namespace

HarmonicField::HarmonicField(Points sources, Matrix weights, Affine affine) {
  const Matrix& c = affine.coefficients;
  if (c.rows() != 4 || c.columns() == 0 || c.columns() != weights.columns())
    throw DataError("field: the affine part has " + std::to_string(c.rows()) + " x " +
                    std::to_string(c.columns()) + " coefficients for " +
                    std::to_string(weights.columns()) + " channels; it needs 4 a channel");
  bool finite = isFinite(affine.center);
  for (std::size_t i = 0; i < 4 * c.columns(); ++i) finite = finite && std::isfinite(c.data()[i]);
  if (!finite) throw DataError("field: the affine part is not finite");
  FastSum sum(sources, weights);
  data_ = std::make_shared<Data>(
      Data{std::move(sources), std::move(weights), std::move(affine), std::move(sum)});
}

std::size_t HarmonicField::channels() const { return data_->weights.columns(); }
const Points& HarmonicField::sources() const { return data_->sources; }
const Matrix& HarmonicField::weights() const { return data_->weights; }
const Affine& HarmonicField::affine() const { return data_->affine; }

void HarmonicField::evaluate(const Vec3* points, std::size_t count, double* values,
                             double* gradients) const {
  const Affine& affine = data_->affine;
  for (std::size_t k = 0; k < channels(); ++k) {
    for (std::size_t i = 0; i < count; ++i) values[k * count + i] = affine.value(points[i], k);
    for (std::size_t a = 0; gradients && a < 3; ++a)
      std::fill_n(gradients + (3 * k + a) * count, count, affine.coefficients(1 + a, k));
  }
  data_->sum.plain().addTo(points, count, values, gradients);
}

FieldSamples HarmonicField::evaluate(const Points& points,
                                     const EvaluateFieldSettings& settings) const {
  const FastSumSettings sums = sumSettings(settings);
  FieldSamples out = settings.accuracy > 0
                         ? data_->sum.at(points, sums)
                         : sumCharges(data_->sum.plain(), points, settings.gradients);
  addAffine(data_->affine, points, out);
  return out;
}

void HarmonicField::onLattice(const LatticeBlocks& lattice, const BlockVisitor& visit,
                              const EvaluateFieldSettings& settings, std::string_view stage) const {
  constexpr std::size_t kPoints = 512;
  const Affine& affine = data_->affine;
  const auto withAffine = [&](std::size_t block, const double* values, const double* slopes) {
    const auto& first = lattice.blocks[block].first;
    std::vector<double> sums(values, values + kPoints * channels()),
        gradient(slopes, slopes ? slopes + 3 * kPoints * channels() : slopes);
    for (std::size_t k = 0; k < channels(); ++k) {
      for (std::size_t i = 0; i < kPoints; ++i) {
        const Vec3 index{static_cast<double>(first[0]) + static_cast<double>(i >> 6),
                         static_cast<double>(first[1]) + static_cast<double>(i >> 3 & 7),
                         static_cast<double>(first[2]) + static_cast<double>(i & 7)};
        sums[kPoints * k + i] += affine.value(lattice.origin + lattice.spacing * index, k);
      }
      for (std::size_t a = 0; slopes && a < 3; ++a)
        for (std::size_t i = 0; i < kPoints; ++i)
          gradient[kPoints * (3 * k + a) + i] += affine.coefficients(1 + a, k);
    }
    visit(block, sums.data(), slopes ? gradient.data() : nullptr);
  };
  data_->sum.onLattice(lattice, withAffine, sumSettings(settings), stage);
}

}  // namespace innermap
