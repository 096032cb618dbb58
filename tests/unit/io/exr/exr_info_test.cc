
#include <gtest/gtest.h>

#include "innermap/core/error.h"
#include "innermap/io/exr/exr_slices.h"
#include "io/test_files.h"

namespace innermap {
namespace {

TEST(ExrInfo, BadFilesAreFileErrors) {
  openvdb::initialize();
  const test::TemporaryFolder folder;
  const auto grid = test::block<openvdb::FloatGrid>(
      "v", openvdb::CoordBBox(openvdb::Coord(0), openvdb::Coord(9)), [](auto) { return 1.0f; });
  writeExrSlices(folder.file("s.exr"), {grid}, {});
  EXPECT_EQ(readExrInfo(folder.file("s.exr")).size(), 10u);
  const std::string text = describe(readExrInfo(folder.file("s.exr")), "s.exr");
  EXPECT_EQ(text.substr(0, text.find('\n')), "s.exr: EXR, 10 parts");
  EXPECT_NE(text.find("10 x 10: mask.V, v.V"), std::string::npos) << text;
  const std::string whole = test::contents(folder.file("s.exr"));
  EXPECT_THROW(readExrInfo(folder.file("missing.exr")), FileError);
  for (const std::size_t length : {0, 3, 8, 40, 200}) {
    test::write(folder.file("t.exr"), whole.substr(0, length));
    EXPECT_THROW(readExrInfo(folder.file("t.exr")), FileError) << length;
  }
  test::write(folder.file("t.exr"), "not an image at all");
  EXPECT_THROW(readExrInfo(folder.file("t.exr")), FileError);
}

}  // namespace
}  // namespace innermap
