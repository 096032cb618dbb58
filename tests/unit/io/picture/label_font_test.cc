#include <gtest/gtest.h>

#include <filesystem>

#include "innermap/io/pictures.h"

namespace innermap {
namespace {

TEST(LabelFont, IsAFileOrNone) {
  const std::string& font = labelFont();
  EXPECT_TRUE(font.empty() || std::filesystem::is_regular_file(font)) << font;
  EXPECT_EQ(&font, &labelFont());
}

}  // namespace
}  // namespace innermap
