#include "solve/lapack_status.h"

#include <gtest/gtest.h>

namespace innermap {
namespace {

TEST(LapackStatus, WantOfMemoryIsNoFailureOfTheNumbers) {
  EXPECT_TRUE(lapackSucceeded(0));
  EXPECT_FALSE(lapackSucceeded(3));
  EXPECT_FALSE(lapackSucceeded(-2));
  EXPECT_THROW(lapackSucceeded(LAPACK_WORK_MEMORY_ERROR), std::bad_alloc);
  EXPECT_THROW(lapackSucceeded(LAPACK_TRANSPOSE_MEMORY_ERROR), std::bad_alloc);
}

}  // namespace
}  // namespace innermap
