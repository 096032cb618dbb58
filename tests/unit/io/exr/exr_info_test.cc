#include <gtest/gtest.h>

#include "core/expect.h"
#include "innermap/core/error.h"
#include "innermap/core/memory.h"
#include "innermap/io/exr_slices.h"
#include "io/test_files.h"

namespace innermap {
namespace {

TEST(ExrInfo, BadFilesAreFileErrors) {
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

// OpenEXR reads what it knows by its type and the rest by its length, and allocates first.
TEST(ExrInfo, LengthsOfAttributes) {
  const test::TemporaryFolder folder;
  const auto grid = test::block<openvdb::FloatGrid>(
      "v", openvdb::CoordBBox(openvdb::Coord(0), openvdb::Coord(9)), [](auto) { return 1.0f; });
  writeExrSlices(folder.file("s.exr"), {grid}, {});
  const std::string whole = test::contents(folder.file("s.exr"));
  using namespace std::string_literals;
  const struct {
    std::string from, to, message;
  } damages[] = {
      {"sliceCount\0int\0\4\0\0\0"s, "sliceCount\0int\0\14\0\0\0"s, "wrong length"},
      {"channels\0chlist\0"s, "channels\0chlist\0\377"s, "wrong length"},
      {"slicePosition\0double\0\10\0\0\0"s, "slicePosition\0doubts\0\10\0\0\100"s,
       "longer than the file"},
      {"chunkCount\0int\0\4\0\0\0\1\0\0\0"s, "chunkCount\0int\0\4\0\0\0\0\0\0\100"s, "too short"}};
  const std::uint64_t before = peakMemory();
  for (const auto& damage : damages) {
    std::string bytes = whole;
    const std::size_t at = bytes.find(damage.from);
    ASSERT_NE(at, bytes.npos) << damage.to;
    bytes.replace(at, damage.to.size(), damage.to);
    test::write(folder.file("t.exr"), bytes);
    test::expectRefused<FileError>([&] { readExrInfo(folder.file("t.exr")); }, damage.message);
  }
  EXPECT_LT(peakMemory() - before, 200u << 20);
}

}  // namespace
}  // namespace innermap
