#include "solve/detail/coarse_solver.h"

#include <cblas.h>
#include <lapacke.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/random.h"
#include "innermap/core/error.h"
#include "innermap/core/run.h"
#include "innermap/solve/kernel_sum.h"
#include "solve/detail/blocked_qr.h"

namespace innermap {
namespace {

constexpr double kLambda = 1e-3;      // relative
constexpr std::size_t kColumns = 64;  // of a task

// c = columns [begin, end) of a, transposed, times b.
void multiplyTransposed(const Matrix& a, std::size_t begin, std::size_t end, const Matrix& b,
                        std::size_t firstColumn, std::size_t columns, double* c,
                        std::size_t stride) {
  const int rows = static_cast<int>(a.rows());
  cblas_dgemm(CblasColMajor, CblasTrans, CblasNoTrans, static_cast<int>(end - begin),
              static_cast<int>(columns), rows, 1, a.column(begin), rows, b.column(firstColumn),
              rows, 0, c, static_cast<int>(stride));
}

// a^T a, of which the lower triangle is filled.
Matrix normalMatrix(const Matrix& a) {
  const std::size_t n = a.columns();
  Matrix out(n, n);
  parallelBlocks(n, kColumns, [&](std::size_t begin, std::size_t end) {
    multiplyTransposed(a, begin, n, a, begin, end - begin, out.column(begin) + begin, n);
  });
  return out;
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
  return 8 * (CoarseSolver::kPointsPerSource + 2) * static_cast<std::uint64_t>(sources) * sources;
}

CoarseSolver::CoarseSolver(const Collocation& collocation, const Points& sources,
                           std::uint64_t seed)
    : rows_(drawn(collocation.size(), kPointsPerSource * sources.size() + kAffine, seed)) {
  const std::size_t count = sources.size(), unknowns = kAffine + count;
  const Collocation seen = collocation.subset(rows_);
  matrix_ = Matrix(rows_.size(), unknowns);
  fillAffineRows(seen, matrix_.data(), matrix_.rows());
  fillKernelMatrix(seen.points, sources, 1, matrix_.column(kAffine), matrix_.rows());
  fillDerivativeRows(seen, sources, matrix_.column(kAffine), matrix_.rows());
  const SingleThreadedBlas guard;
  factor_ = normalMatrix(matrix_);
  double trace = 0;
  for (std::size_t j = kAffine; j < unknowns; ++j) trace += factor_(j, j);
  for (std::size_t j = kAffine; j < unknowns; ++j)
    factor_(j, j) += kLambda * kLambda * trace / static_cast<double>(count);
  const int n = static_cast<int>(unknowns);
  if (LAPACKE_dpotrf(LAPACK_COL_MAJOR, 'L', n, factor_.data(), n) != 0)
    throw DataError(
        "solve: the first charges' matrix is singular; the points lie in one plane, or hold NaN or "
        "infinite numbers");
}

Matrix CoarseSolver::correction(const Matrix& residual) const {
  const std::size_t unknowns = factor_.rows(), channels = residual.columns();
  Matrix b(rows_.size(), channels), out(unknowns, channels);
  for (std::size_t k = 0; k < channels; ++k)
    for (std::size_t i = 0; i < rows_.size(); ++i) b(i, k) = residual(rows_[i], k);
  const SingleThreadedBlas guard;
  parallelBlocks(unknowns, kColumns, [&](std::size_t begin, std::size_t end) {
    multiplyTransposed(matrix_, begin, end, b, 0, channels, out.data() + begin, unknowns);
  });
  const int n = static_cast<int>(unknowns);
  LAPACKE_dpotrs(LAPACK_COL_MAJOR, 'L', n, static_cast<int>(channels), factor_.data(), n,
                 out.data(), n);
  return out;
}

}  // namespace innermap
