#include <gtest/gtest.h>

#include "innermap/fit/fit_map.h"

namespace innermap {
namespace {

TEST(ShellCollocation, IsSomeOfEachSourceUnlessGiven) {
  EXPECT_EQ(shellCollocation({.sources = 1000}), 4000U);
  EXPECT_EQ(shellCollocation({.sources = 10000}), 30000U);
  EXPECT_EQ(shellCollocation({.sources = 1}), 16U);
  EXPECT_EQ(shellCollocation({.sources = 1, .collocation = 77}), 77U);
}

}  // namespace
}  // namespace innermap
