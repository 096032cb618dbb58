#include "solve/detail/coarse_solver.h"

#include <cblas.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/random.h"
#include "innermap/solve/kernel_sum.h"

namespace innermap {
namespace {

constexpr double kLambda = 1e-3;  // relative

// Of columns from `firstColumn` on, over the first `rows`.
double meanSquaredNorm(const Matrix& a, std::size_t firstColumn, std::size_t rows) {
  double sum = 0;
  for (std::size_t j = firstColumn; j < a.columns(); ++j)
    for (std::size_t i = 0; i < rows; ++i) sum += a(i, j) * a(i, j);
  return sum / static_cast<double>(a.columns() - firstColumn);
}

std::vector<std::size_t> drawn(std::size_t from, std::size_t count, std::uint64_t seed) {
  std::vector<std::size_t> order(from);
  std::iota(order.begin(), order.end(), 0);
  const CounterRandom random(seed, 11);
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return std::make_pair(random.bits(a), a) < std::make_pair(random.bits(b), b);
  });
  order.resize(std::min(from, count));
  std::sort(order.begin(), order.end());
  return order;
}

}  // namespace

std::uint64_t coarseSolverMemory(std::size_t sources) {
  return 8 * (CoarseSolver::kPointsPerSource + 3) * static_cast<std::uint64_t>(sources) * sources;
}

CoarseSolver::CoarseSolver(const Collocation& collocation, const Points& sources,
                           std::uint64_t seed)
    : rows_(drawn(collocation.size(), kPointsPerSource * sources.size() + kAffine, seed)) {
  const std::size_t rows = rows_.size(), count = sources.size();
  const Collocation seen = collocation.subset(rows_);
  Matrix a(rows + count, kAffine + count);
  fillAffineRows(seen, a.data(), a.rows());
  fillKernelMatrix(seen.points, sources, 1, a.column(kAffine), a.rows());
  fillDerivativeRows(seen, sources, a.column(kAffine), a.rows());
  const double lambda = kLambda * std::sqrt(meanSquaredNorm(a, kAffine, rows));
  for (std::size_t j = 0; j < count; ++j) a(rows + j, kAffine + j) = lambda;
  qr_ = BlockedQr(std::move(a));
  triangle_ = qr_.upperTriangle();
}

Matrix CoarseSolver::correction(const Matrix& residual) const {
  const std::size_t rows = rows_.size(), unknowns = triangle_.rows(), channels = residual.columns();
  Matrix b(rows + unknowns - kAffine, channels);
  for (std::size_t k = 0; k < channels; ++k)
    for (std::size_t i = 0; i < rows; ++i) b(i, k) = residual(rows_[i], k);
  qr_.applyTransposedQ(b);
  const SingleThreadedBlas guard;
  cblas_dtrsm(CblasColMajor, CblasLeft, CblasUpper, CblasNoTrans, CblasNonUnit,
              static_cast<int>(unknowns), static_cast<int>(channels), 1, triangle_.data(),
              static_cast<int>(unknowns), b.data(), static_cast<int>(b.rows()));
  Matrix out(unknowns, channels);
  for (std::size_t k = 0; k < channels; ++k) std::copy_n(b.column(k), unknowns, out.column(k));
  return out;
}

}  // namespace innermap
