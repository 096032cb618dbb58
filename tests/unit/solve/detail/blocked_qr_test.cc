#include "solve/detail/blocked_qr.h"

#include <gtest/gtest.h>

#include "core/expect.h"
#include "innermap/core/error.h"
#include "solve/points.h"

namespace innermap {
namespace {

TEST(BlockedQr, TurnsTheMatrixIntoItsTriangle) {
  for (const std::size_t columns : {1, 63, 64, 65, 200, 333}) {
    const std::size_t rows = columns + 117;
    const Matrix a = testing::randomWeights(rows, columns, columns);
    const BlockedQr qr(a);
    Matrix b = a;
    qr.applyTransposedQ(b);
    const Matrix r = qr.upperTriangle();
    for (std::size_t j = 0; j < columns; ++j)
      for (std::size_t i = 0; i < rows; ++i)
        ASSERT_NEAR(b(i, j), i < columns ? r(i, j) : 0, 1e-12) << i << ", " << j;
  }
}

TEST(BlockedQr, RefusesWideMatrices) { EXPECT_THROW(BlockedQr(Matrix(3, 4)), SettingError); }

TEST(BlockedQr, CancelStopsIt) {
  test::expectCancels([&] { BlockedQr(testing::randomWeights(200, 100, 1)); });
}

TEST(Multiply, EqualsThePlainLoop) {
  const Matrix a = testing::randomWeights(31, 17, 1), b = testing::randomWeights(17, 300, 2);
  Matrix c(31, 300);
  multiply(false, 2, a, b, 0, c);
  Matrix at(17, 31);
  for (std::size_t i = 0; i < 31; ++i)
    for (std::size_t j = 0; j < 17; ++j) at(j, i) = a(i, j);
  Matrix d(31, 300);
  multiply(true, 2, at, b, 0, d);
  for (std::size_t i = 0; i < 31; ++i)
    for (std::size_t j = 0; j < 300; ++j) {
      double sum = 0;
      for (std::size_t k = 0; k < 17; ++k) sum += 2 * a(i, k) * b(k, j);
      ASSERT_NEAR(c(i, j), sum, 1e-13);
      ASSERT_NEAR(d(i, j), sum, 1e-13);
    }
}

}  // namespace
}  // namespace innermap
