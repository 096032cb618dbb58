// Householder QR of tall dense matrices: panels by LAPACK's recursive dgeqrt, trailing columns in
// fixed blocks on all threads (Schreiber and Van Loan, "A Storage-Efficient WY Representation for
// Products of Householder Transformations", 1989). Unlike a threaded BLAS, the result is the same
// for any number of threads, and it can be cancelled between panels.
#pragma once

#include "innermap/core/matrix.h"

namespace innermap {

class BlockedQr {
 public:
  BlockedQr() = default;

  // Factors `a` (m x n, m >= n) in place of its storage. Throws SettingError when m < n.
  explicit BlockedQr(Matrix a);

  // Q^T b, in place; b has m rows. Its first n rows then belong to R.
  void applyTransposedQ(Matrix& b) const;

  // The upper triangle, n x n, zeros below.
  Matrix upperTriangle() const;

 private:
  Matrix factors_, triangularBlocks_;
};

// Keeps OpenBLAS to the calling thread while it lives: parallelism is ours.
class SingleThreadedBlas {
 public:
  SingleThreadedBlas();
  ~SingleThreadedBlas();
  SingleThreadedBlas(const SingleThreadedBlas&) = delete;
  SingleThreadedBlas& operator=(const SingleThreadedBlas&) = delete;

 private:
  int before_;
};

// c = alpha * op(a) * b + beta * c on all threads, over fixed blocks of columns of c.
// op transposes when transposeA. Shapes must agree.
void multiply(bool transposeA, double alpha, const Matrix& a, const Matrix& b, double beta,
              Matrix& c);

}  // namespace innermap
