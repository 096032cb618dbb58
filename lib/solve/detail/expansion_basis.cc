#include "solve/detail/expansion_basis.h"

#include <cblas.h>
#include <lapacke.h>

#include <array>
#include <cmath>
#include <mutex>

#include "core/pi.h"
#include "innermap/core/error.h"
#include "solve/detail/blocked_qr.h"
#include "solve/detail/expansion_simd.h"

namespace innermap {
namespace {

constexpr double kSphere = 0.85;     // radius of the points, in units of the ball's
constexpr double kPointsPer = 1.05;  // function, at least

std::size_t roundUp(std::size_t n) { return (n + simd::kRows - 1) / simd::kRows * simd::kRows; }

Points fibonacciSphere(std::size_t count) {
  const double golden = kPi * (3 - std::sqrt(5.0));
  Points out(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double at = static_cast<double>(i) + 0.5;
    const double z = 1 - 2 * at / static_cast<double>(count), r = std::sqrt(1 - z * z);
    out[i] = {r * std::cos(golden * at), r * std::sin(golden * at), z};
  }
  return out;
}

// H (H^T H)^-1 of the harmonics at the points: its transpose fits, itself spreads.
Matrix pseudoInverseTransposed(const Matrix& h) {
  const SingleThreadedBlas guard;
  const int m = static_cast<int>(h.rows()), n = static_cast<int>(h.columns());
  Matrix gram(h.columns(), h.columns()), out = h;
  cblas_dsyrk(CblasColMajor, CblasLower, CblasTrans, n, m, 1, h.data(), m, 0, gram.data(), n);
  if (LAPACKE_dpotrf(LAPACK_COL_MAJOR, 'L', n, gram.data(), n) != 0)
    throw DataError("expansions: the points on the sphere do not tell the harmonics apart");
  cblas_dtrsm(CblasColMajor, CblasRight, CblasLower, CblasTrans, CblasNonUnit, m, n, 1, gram.data(),
              n, out.data(), m);
  cblas_dtrsm(CblasColMajor, CblasRight, CblasLower, CblasNoTrans, CblasNonUnit, m, n, 1,
              gram.data(), n, out.data(), m);
  return out;
}

}  // namespace

std::shared_ptr<const ExpansionBasis> ExpansionBasis::get(int order) {
  static std::mutex mutex;
  static std::array<std::shared_ptr<const ExpansionBasis>, kMostOrder + 1> known;
  const std::lock_guard<std::mutex> lock(mutex);
  auto& basis = known.at(static_cast<std::size_t>(order));
  if (!basis) basis = std::make_shared<const ExpansionBasis>(order);
  return basis;
}

ExpansionBasis::ExpansionBasis(int order) : harmonics_(order) {
  const std::size_t functions = harmonics_.count();
  points_ = fibonacciSphere(
      roundUp(static_cast<std::size_t>(std::ceil(kPointsPer * static_cast<double>(functions)))));
  padded_ = roundUp(functions);
  const Matrix h = harmonics_.at(points_), inverse = pseudoInverseTransposed(h);
  for (Vec3& p : points_) p = kSphere * p;
  // N_nm(kSphere u) = kSphere^n N_nm(u): the rows of one order n are scaled alike. The same factor
  // comes out of the functions at two radii.
  const Matrix scaled = harmonics_.at(points_);
  const std::size_t count = points_.size();
  toCoefficients_.assign(padded_ * count, 0);
  toProxies_.assign(count * padded_, 0);
  for (std::size_t c = 0; c < functions; ++c) {
    std::size_t largest = 0;
    for (std::size_t i = 0; i < count; ++i)
      if (std::abs(h(i, c)) > std::abs(h(largest, c))) largest = i;
    const double factor = h(largest, c) / scaled(largest, c);
    for (std::size_t i = 0; i < count; ++i) {
      toCoefficients_[i * padded_ + c] = factor * inverse(i, c);
      toProxies_[c * count + i] = factor * inverse(i, c);
    }
  }
}

void ExpansionBasis::coefficients(const double* values, double* out) const {
  simd::multiplyThree(toCoefficients_.data(), padded_, points_.size(), values, points_.size(), out);
}

// Columns beyond the functions are zeros.
void ExpansionBasis::proxyWeights(const double* moments, double* out) const {
  simd::multiplyThree(toProxies_.data(), points_.size(), padded_, moments, padded_, out);
}

}  // namespace innermap
