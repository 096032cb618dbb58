#include <gtest/gtest.h>

#include "innermap/solve/solver.h"

namespace innermap {
namespace {

TEST(Affine, ValueIsTakenAboutTheCentre) {
  Affine f;
  f.center = {1, 2, 3};
  f.coefficients = Matrix(4, 2);
  for (int i = 0; i < 4; ++i) f.coefficients(i, 1) = 1 + i;
  EXPECT_DOUBLE_EQ(f.value({1, 2, 3}, 1), 1);
  EXPECT_DOUBLE_EQ(f.value({2, 3, 4}, 1), 1 + 2 + 3 + 4);
  EXPECT_DOUBLE_EQ(f.value({2, 3, 4}, 0), 0);
}

}  // namespace
}  // namespace innermap
