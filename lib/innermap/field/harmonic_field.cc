#include "innermap/field/harmonic_field.h"

#include <algorithm>
#include <cmath>

#include "innermap/core/error.h"
#include "innermap/core/parallel.h"

namespace innermap {

struct HarmonicField::Data {
  Points sources;
  Matrix weights;
  Affine affine;
  Charges charges;
};

HarmonicField::HarmonicField(Points sources, Matrix weights, Affine affine) {
  const Matrix& c = affine.coefficients;
  if (c.rows() != 4 || c.columns() == 0 || c.columns() != weights.columns())
    throw DataError("field: the affine part has " + std::to_string(c.rows()) + " x " +
                    std::to_string(c.columns()) + " coefficients for " +
                    std::to_string(weights.columns()) + " channels; it needs 4 a channel");
  bool finite = isFinite(affine.center);
  for (std::size_t i = 0; i < 4 * c.columns(); ++i) finite = finite && std::isfinite(c.data()[i]);
  if (!finite) throw DataError("field: the affine part is not finite");
  Charges charges(sources, weights);
  data_ = std::make_shared<Data>(
      Data{std::move(sources), std::move(weights), std::move(affine), std::move(charges)});
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
  data_->charges.addTo(points, count, values, gradients);
}

FieldSamples HarmonicField::evaluate(const Points& points, bool gradients,
                                     Progress* progress) const {
  FieldSamples out = sumCharges(data_->charges, points, gradients, progress);
  const Affine& affine = data_->affine;
  for (std::size_t k = 0; k < channels(); ++k)
    for (std::size_t i = 0; i < points.size(); ++i) {
      out.values(i, k) += affine.value(points[i], k);
      for (std::size_t a = 0; gradients && a < 3; ++a)
        out.gradients(i, 3 * k + a) += affine.coefficients(1 + a, k);
    }
  return out;
}

}  // namespace innermap
