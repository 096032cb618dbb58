#include "solve/detail/directions.h"

#include <gtest/gtest.h>

#include "solve/points.h"

namespace innermap {
namespace {

Matrix product(const Matrix& a, const Matrix& b) {
  Matrix c(a.rows(), b.columns());
  for (std::size_t i = 0; i < a.rows(); ++i)
    for (std::size_t j = 0; j < b.columns(); ++j)
      for (std::size_t k = 0; k < b.rows(); ++k) c(i, j) += a(i, k) * b(k, j);
  return c;
}

// With as many directions as unknowns the residual is that of least squares: orthogonal to the
// operator's image; and the residual always is b - A x.
TEST(Directions, ManyDirectionsGiveLeastSquares) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const Matrix a = testing::randomWeights(30, 8, seed),
                 b = testing::randomWeights(30, 3, seed + 10);
    Matrix residual = b, x(8, 3);
    OrthogonalDirections directions(30, 8);
    for (int round = 0; round < 3; ++round) {
      const Matrix z = testing::randomWeights(8, 4, seed + 100 + static_cast<std::uint64_t>(round));
      const std::size_t before = directions.count();
      directions.add(z, product(a, z));
      directions.project(before, residual, x);
    }
    EXPECT_EQ(directions.count(), 8u);
    const Matrix ax = product(a, x);
    for (std::size_t k = 0; k < 3; ++k) {
      for (std::size_t i = 0; i < 30; ++i) EXPECT_NEAR(residual(i, k), b(i, k) - ax(i, k), 1e-11);
      for (std::size_t j = 0; j < 8; ++j) {
        double inner = 0;
        for (std::size_t i = 0; i < 30; ++i) inner += a(i, j) * residual(i, k);
        EXPECT_NEAR(inner, 0, 1e-10);
      }
    }
  }
}

// The second channel has a little of the first direction, then much of another, and x is nothing
// yet: the little is a large change at first, and none in the end.
TEST(Directions, LittleIsJudgedWhenAllElseIsTaken) {
  Matrix identity(4, 3), b(4, 2);
  for (std::size_t i = 0; i < 3; ++i) identity(i, i) = 1;
  b(0, 0) = 1;
  b(0, 1) = 1e-6;
  b(1, 1) = 1e-4;
  b(2, 1) = 1;
  Matrix residual = b, x(3, 2);
  OrthogonalDirections directions(4, 3);
  Matrix z(3, 3);
  for (std::size_t i = 0; i < 3; ++i) z(i, i) = 1;
  directions.add(z, identity);
  directions.project(0, residual, x);
  for (std::size_t k = 0; k < 2; ++k)
    for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(residual(i, k), 0, 1e-15);
}

TEST(Directions, DependentAndZeroColumnsAreLeftOut) {
  const Matrix a = testing::randomWeights(20, 4, 1), z = testing::randomWeights(4, 2, 2);
  Matrix residual = testing::randomWeights(20, 1, 3), x(4, 1);
  OrthogonalDirections directions(20, 4);
  directions.add(z, product(a, z));
  directions.project(0, residual, x);
  const Matrix before = residual;
  EXPECT_EQ(directions.count(), 2u);
  directions.add(z, product(a, z));
  directions.add(Matrix(4, 1), Matrix(20, 1));
  EXPECT_EQ(directions.count(), 2u);
  directions.project(2, residual, x);
  for (std::size_t i = 0; i < 20; ++i) EXPECT_EQ(residual(i, 0), before(i, 0));
}

}  // namespace
}  // namespace innermap
