#include <gtest/gtest.h>

#include "innermap/solve/kernel_sum.h"
#include "innermap/solve/solver.h"

namespace innermap {
namespace {

const Points kPoints{{1, 0, 0}, {0, 1, 0.5}, {-0.3, 0.2, 1}};
const Points kDirections{{0, 0, 0}, {0.5, -1, 2}, {0, 0, 0}};

TEST(Collocation, RowsAreValuesAndDerivatives) {
  const Collocation at(kPoints, kDirections);
  const Points sources{{2, 1, 0}, {0, -2, 1}};
  Matrix weights(2, 1);
  weights(0, 0) = 1.5;
  weights(1, 0) = -0.7;
  Matrix rows(3, 2);
  fillKernelMatrix(kPoints, sources, 1, rows.data(), 3);
  fillDerivativeRows(at, sources, rows.data(), 3);
  const FieldSamples exact = sumCharges(Charges(sources, weights), kPoints, true);
  const std::vector<std::size_t> derivatives = derivativeRows(at);
  ASSERT_EQ(derivatives, std::vector<std::size_t>{1});
  Matrix gradients(1, 3);
  for (std::size_t a = 0; a < 3; ++a) gradients(0, a) = exact.gradients(1, a);
  const Matrix wanted = rowValues(at, exact.values, gradients);
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_NEAR(rows(i, 0) * 1.5 - 0.7 * rows(i, 1), wanted(i, 0), 1e-13);
  EXPECT_EQ(at.affine(0), (std::array<double, 4>{1, 1, 0, 0}));
  EXPECT_EQ(at.affine(1), (std::array<double, 4>{0, 0.5, -1, 2}));
}

TEST(Collocation, AppendKeepsRowsApart) {
  Collocation all(kPoints);
  EXPECT_TRUE(derivativeRows(all).empty());
  all.append(Collocation(kPoints, kDirections));
  all.append(Collocation(kPoints));
  EXPECT_EQ(all.size(), 9u);
  EXPECT_EQ(derivativeRows(all), std::vector<std::size_t>{4});
  EXPECT_EQ(derivativeRows(all.subset({8, 4})), std::vector<std::size_t>{1});
}

}  // namespace
}  // namespace innermap
