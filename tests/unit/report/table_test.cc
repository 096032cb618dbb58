#include "report/table.h"

#include <gtest/gtest.h>

#include <cmath>

#include "innermap/core/error.h"
#include "io/test_files.h"

namespace innermap {
namespace {

TEST(Table, HasALineOfKeysAndOneForEachRow) {
  const test::TemporaryFolder folder;
  writeTable(folder.file("t.csv"),
             {{"frame", std::vector<double>{1, 20}, "frames"},
              {"error", std::vector<double>{1.0 / 3, std::nan("")}, "errors"},
              {"file", std::vector<std::string>{"a,b.obj", "say \"c\""}, "files"}});
  EXPECT_EQ(test::contents(folder.file("t.csv")),
            "frame,error,file\n1,0.333333333,\"a,b.obj\"\n20,,\"say \"\"c\"\"\"\n");
}

TEST(Table, RefusesWhatAreNoColumns) {
  const test::TemporaryFolder folder;
  EXPECT_THROW(writeTable(folder.file("t.csv"), {{"one", 1.0, "one"}}), Error);
  EXPECT_THROW(writeTable(folder.file("t.csv"),
                          {{"a", std::vector<double>{1}, "a"}, {"b", std::vector<double>{}, "b"}}),
               Error);
  EXPECT_EQ(folder.count(), 0u);
}

}  // namespace
}  // namespace innermap
