#include "solve/detail/blocked_qr.h"

#include <cblas.h>
#include <lapacke.h>

#include <algorithm>
#include <string>

#include "innermap/core/error.h"
#include "innermap/core/run.h"
#include "solve/detail/blas_kernels.h"
#include "solve/detail/blas_memory.h"

extern "C" {
int openblas_get_num_threads();
void openblas_set_num_threads(int threads);
}

namespace innermap {
namespace {

constexpr std::size_t kPanel = 64;         // columns factored at once
constexpr std::size_t kColumnBlock = 128;  // trailing columns updated by one task

// Before main, when no other thread can be in BLAS.
[[maybe_unused]] const char* const kKernels = chooseBlasKernels();

lapack_int toLapack(std::size_t n) { return static_cast<lapack_int>(n); }

// Columns [begin, end) of c become (I - V T V^T)^T c, for the panel of reflectors in rows
// [row, m) of `factors`.
void applyPanel(const Matrix& factors, const Matrix& blocks, std::size_t row, std::size_t width,
                double* c, std::size_t columns, std::size_t stride) {
  std::vector<double> work(columns * width);
  LAPACKE_dlarfb_work(LAPACK_COL_MAJOR, 'L', 'T', 'F', 'C', toLapack(factors.rows() - row),
                      toLapack(columns), toLapack(width), factors.column(row) + row,
                      toLapack(factors.rows()), blocks.column(row), toLapack(kPanel), c + row,
                      toLapack(stride), work.data(), toLapack(columns));
}

}  // namespace

SingleThreadedBlas::SingleThreadedBlas() : before_(openblas_get_num_threads()) {
  requireBlasMemory();
  openblas_set_num_threads(1);
}
SingleThreadedBlas::~SingleThreadedBlas() { openblas_set_num_threads(before_); }

BlockedQr::BlockedQr(Matrix a)
    : factors_(std::move(a)), triangularBlocks_(kPanel, factors_.columns()) {
  const std::size_t m = factors_.rows(), n = factors_.columns();
  if (m < n)
    throw SettingError("collocation points", std::to_string(m) + " are fewer than " +
                                                 std::to_string(n) + " unknowns; use more");
  const SingleThreadedBlas guard;
  for (std::size_t k = 0; k < n; k += kPanel) {
    const std::size_t width = std::min(kPanel, n - k);
    std::vector<double> work(width * width);
    LAPACKE_dgeqrt_work(LAPACK_COL_MAJOR, toLapack(m - k), toLapack(width), toLapack(width),
                        factors_.column(k) + k, toLapack(m), triangularBlocks_.column(k),
                        toLapack(kPanel), work.data());
    const std::size_t rest = k + width;
    parallelBlocks(n - rest, kColumnBlock, [&](std::size_t begin, std::size_t end) {
      applyPanel(factors_, triangularBlocks_, k, width, factors_.column(rest + begin), end - begin,
                 m);
    });
    const double left = static_cast<double>(n - rest) / static_cast<double>(n);
    reportProgress("factoring", 1 - left * left);
  }
}

void BlockedQr::applyTransposedQ(Matrix& b) const {
  const SingleThreadedBlas guard;
  const std::size_t n = factors_.columns();
  parallelBlocks(b.columns(), kColumnBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = 0; k < n; k += kPanel)
      applyPanel(factors_, triangularBlocks_, k, std::min(kPanel, n - k), b.column(begin),
                 end - begin, b.rows());
  });
}

Matrix BlockedQr::upperTriangle() const {
  const std::size_t n = factors_.columns();
  Matrix r(n, n);
  for (std::size_t j = 0; j < n; ++j) std::copy_n(factors_.column(j), j + 1, r.column(j));
  return r;
}

void multiply(bool transposeA, double alpha, const Matrix& a, const Matrix& b, double beta,
              Matrix& c) {
  const SingleThreadedBlas guard;
  const std::size_t inner = transposeA ? a.rows() : a.columns();
  if (inner == 0 || c.rows() == 0) return;
  parallelBlocks(c.columns(), kColumnBlock, [&](std::size_t begin, std::size_t end) {
    cblas_dgemm(CblasColMajor, transposeA ? CblasTrans : CblasNoTrans, CblasNoTrans,
                static_cast<int>(c.rows()), static_cast<int>(end - begin), static_cast<int>(inner),
                alpha, a.data(), static_cast<int>(a.rows()), b.column(begin),
                static_cast<int>(b.rows()), beta, c.column(begin), static_cast<int>(c.rows()));
  });
}

}  // namespace innermap
