#include "innermap/core/matrix.h"

#include <gtest/gtest.h>

namespace innermap {
namespace {

TEST(Matrix, ColumnsAreContiguous) {
  Matrix m(3, 2);
  m(2, 0) = 5;
  m(0, 1) = 7;
  EXPECT_EQ(m.data()[2], 5);
  EXPECT_EQ(m.data()[3], 7);
  EXPECT_EQ(m.column(1), m.data() + 3);
  EXPECT_TRUE(Matrix().empty());
}

}  // namespace
}  // namespace innermap
