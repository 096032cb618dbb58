// The affine part of boundary values, taken off before charges are fitted to what is left.
#pragma once

#include "innermap/core/matrix.h"
#include "innermap/solve/solver.h"

namespace innermap {

constexpr std::size_t kAffineUnknowns = 4;  // of 1, x, y, z

// R^-1 b, in place, for the upper triangle of the affine functions' QR (4 x 4). Affine directions
// that the points do not span (a plane, a line) get 0.
void solveAffineTriangle(const Matrix& r, Matrix& b);

// Least squares over the rows: coefficients of 1, x, y, z, 4 x #K. Affine values leave no more than
// rounding, whatever the shape of the solid. values: #points x #K. Throws SettingError when there
// are fewer than four points.
Matrix fitAffine(const Collocation& at, const Matrix& values);

}  // namespace innermap
