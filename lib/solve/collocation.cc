#include <cmath>

#include "innermap/solve/solver.h"

namespace innermap {

Collocation Collocation::normalised(const Vec3& center, double scale) const {
  Collocation out = *this;
  for (Vec3& p : out.points) p = (p - center) / scale;
  for (Vec3& d : out.directions) d = d / scale;
  return out;
}

Collocation Collocation::subset(const std::vector<std::size_t>& indices) const {
  Collocation out;
  out.points.reserve(indices.size());
  for (const std::size_t i : indices) out.points.push_back(points[i]);
  if (directions.empty()) return out;
  out.directions.reserve(indices.size());
  for (const std::size_t i : indices) out.directions.push_back(directions[i]);
  return out;
}

void Collocation::append(const Collocation& other) {
  if (!other.directions.empty()) directions.resize(points.size());
  points.insert(points.end(), other.points.begin(), other.points.end());
  directions.insert(directions.end(), other.directions.begin(), other.directions.end());
  if (!directions.empty()) directions.resize(points.size());
}

std::vector<std::size_t> derivativeRows(const Collocation& at) {
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < at.directions.size(); ++i)
    if (at.derivative(i)) out.push_back(i);
  return out;
}

void fillAffineRows(const Collocation& at, double* out, std::size_t rowStride) {
  for (std::size_t i = 0; i < at.size(); ++i) {
    const std::array<double, 4> row = at.affine(i);
    for (std::size_t k = 0; k < row.size(); ++k) out[k * rowStride + i] = row[k];
  }
}

void fillDerivativeRows(const Collocation& at, const Points& sources, double* out,
                        std::size_t rowStride) {
  const std::vector<std::size_t> rows = derivativeRows(at);
  for (std::size_t j = 0; j < sources.size() && !rows.empty(); ++j)
    for (const std::size_t i : rows) {
      const Vec3 r = at.points[i] - sources[j];
      const double square = dot(r, r);
      out[j * rowStride + i] =
          square > 0 ? -dot(at.directions[i], r) / (square * std::sqrt(square)) : 0;
    }
}

Matrix rowValues(const Collocation& at, Matrix values, const Matrix& gradients) {
  const std::vector<std::size_t> rows = derivativeRows(at);
  for (std::size_t k = 0; k < values.columns(); ++k)
    for (std::size_t r = 0; r < rows.size(); ++r) {
      const Vec3& d = at.directions[rows[r]];
      values(rows[r], k) =
          d.x * gradients(r, 3 * k) + d.y * gradients(r, 3 * k + 1) + d.z * gradients(r, 3 * k + 2);
    }
  return values;
}

}  // namespace innermap
