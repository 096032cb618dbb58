#include "innermap/core/error.h"

#include <gtest/gtest.h>

namespace innermap {
namespace {

TEST(Error, MessagesNameFileAndSetting) {
  EXPECT_STREQ(FileError("a.obj", "is empty").what(), "a.obj: is empty");
  // With a short name GCC 12 warns at -O1, falsely, of the bounds of the text.
  EXPECT_STREQ(SettingError("--surface-resolution", "must be whole").what(),
               "--surface-resolution: must be whole");
  EXPECT_THROW(throw Cancelled(), Error);
}

}  // namespace
}  // namespace innermap
