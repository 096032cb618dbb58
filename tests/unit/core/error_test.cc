#include "innermap/core/error.h"

#include <gtest/gtest.h>

namespace innermap {
namespace {

TEST(Error, MessagesNameFileAndSetting) {
  EXPECT_STREQ(FileError("a.obj", "is empty").what(), "a.obj: is empty");
  EXPECT_STREQ(SettingError("--seed", "must be whole").what(), "--seed: must be whole");
  EXPECT_THROW(throw Cancelled(), Error);
}

}  // namespace
}  // namespace innermap
