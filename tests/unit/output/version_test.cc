#include "innermap/output/version.h"

#include <gtest/gtest.h>

#include <regex>

namespace innermap {
namespace {

TEST(Version, IsThreeNumbers) {
  EXPECT_TRUE(std::regex_match(versionText(), std::regex("[0-9]+\\.[0-9]+\\.[0-9]+")));
}

}  // namespace
}  // namespace innermap
