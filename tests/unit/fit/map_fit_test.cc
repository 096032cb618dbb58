#include <gtest/gtest.h>

#include "innermap/fit/fit_map.h"

namespace innermap {
namespace {

TEST(ShellCollocation, IsSomeOfEachSourceUnlessGiven) {
  ShellSettings shell;
  shell.sources = 1000;
  EXPECT_EQ(shellCollocation(shell), 4000U);
  shell.sources = 10000;
  EXPECT_EQ(shellCollocation(shell), 30000U);
  shell.sources = 1;
  EXPECT_EQ(shellCollocation(shell), 16U);
  shell.collocation = 77;
  EXPECT_EQ(shellCollocation(shell), 77U);
}

}  // namespace
}  // namespace innermap
