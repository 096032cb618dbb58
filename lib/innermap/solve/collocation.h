// Where a field is fitted and what it is asked for there: one row of the least squares a point.
#pragma once

#include <array>
#include <cstddef>
#include <utility>
#include <vector>

#include "innermap/core/matrix.h"
#include "innermap/core/vec3.h"

namespace innermap {

struct Collocation {
  Points points;
  // Empty: the field's value everywhere. Else one a point: zero asks for the value, any other one
  // for its scalar product with the gradient, which is the derivative along it times its length.
  // The length weights the row: a derivative counts as the change of value over it.
  Points directions;

  Collocation() = default;
  // NOLINTNEXTLINE(google-explicit-constructor): points alone ask for values
  Collocation(Points at, Points along = {}) : points(std::move(at)), directions(std::move(along)) {}

  std::size_t size() const { return points.size(); }
  bool derivative(std::size_t i) const {
    return !directions.empty() &&
           (directions[i].x != 0 || directions[i].y != 0 || directions[i].z != 0);
  }
  // What the row of point i makes of the affine functions 1, x, y, z.
  std::array<double, 4> affine(std::size_t i) const {
    const Vec3& v = derivative(i) ? directions[i] : points[i];
    return {derivative(i) ? 0.0 : 1.0, v.x, v.y, v.z};
  }
  // In units of `scale` about `center`: the same rows for fields in these units.
  Collocation normalised(const Vec3& center, double scale) const;
  Collocation subset(const std::vector<std::size_t>& indices) const;
  void append(const Collocation& other);
};

// Rows where derivatives are asked for: those indices, in order.
std::vector<std::size_t> derivativeRows(const Collocation& at);

// Fills #points x 4 by the affine functions' rows, column-major with the given stride.
void fillAffineRows(const Collocation& at, double* out, std::size_t rowStride);

// Overwrites these rows of #points x #sources, `column`-major with the given stride, by
//   -direction . (point - source) / |point - source|^3.
void fillDerivativeRows(const Collocation& at, const Points& sources, double* out,
                        std::size_t rowStride);

// The rows' values of a field: #points x #K. values: #points x #K; gradients: of derivativeRows(at)
// alone, #rows x 3 #K, columns 3 k + axis.
Matrix rowValues(const Collocation& at, Matrix values, const Matrix& gradients);

}  // namespace innermap
