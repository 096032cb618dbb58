#include "solve/detail/affine_fit.h"

#include <algorithm>
#include <cmath>

#include "solve/detail/blocked_qr.h"

namespace innermap {

void solveAffineTriangle(const Matrix& r, Matrix& b) {
  double largest = 0;
  for (std::size_t i = 0; i < kAffineUnknowns; ++i) largest = std::max(largest, std::abs(r(i, i)));
  for (std::size_t c = 0; c < b.columns(); ++c)
    for (std::size_t i = kAffineUnknowns; i-- > 0;) {
      double sum = b(i, c);
      for (std::size_t j = i + 1; j < kAffineUnknowns; ++j) sum -= r(i, j) * b(j, c);
      b(i, c) = std::abs(r(i, i)) > 1e-12 * largest ? sum / r(i, i) : 0;
    }
}

Matrix fitAffine(const Collocation& at, const Matrix& values) {
  Matrix a(at.size(), kAffineUnknowns);
  fillAffineRows(at, a.data(), a.rows());
  const BlockedQr qr(std::move(a));
  Matrix projected = values;
  qr.applyTransposedQ(projected);
  Matrix out(kAffineUnknowns, values.columns());
  for (std::size_t k = 0; k < values.columns(); ++k)
    std::copy_n(projected.column(k), kAffineUnknowns, out.column(k));
  solveAffineTriangle(qr.upperTriangle(), out);
  return out;
}

}  // namespace innermap
