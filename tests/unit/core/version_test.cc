#include "innermap/core/version.h"

#include <gtest/gtest.h>

#include <cstdio>

namespace innermap {
namespace {

TEST(Version, IsThreeNumbers) {
  int major = 0, minor = 0, patch = 0;
  char rest = 0;
  EXPECT_EQ(std::sscanf(versionText(), "%d.%d.%d%c", &major, &minor, &patch, &rest), 3);
}

}  // namespace
}  // namespace innermap
