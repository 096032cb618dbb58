#include "innermap/core/file.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "innermap/core/error.h"

namespace innermap {
namespace {

namespace fs = std::filesystem;

class FileTest : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("innermap_file_" + std::to_string(getpid()));
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  std::string at(const char* name) const { return (folder_ / name).string(); }
  std::size_t entries() const {
    return static_cast<std::size_t>(
        std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
  }
  fs::path folder_;
};

TEST_F(FileTest, AppearsOnCommitOnly) {
  {
    PendingFile file(at("a"));
    EXPECT_FALSE(fs::exists(at("a")));
    EXPECT_TRUE(fs::exists(file.temporaryPath()));
  }
  EXPECT_EQ(entries(), 0u);
  {
    PendingFile file(at("a"));
    file.commit();
  }
  EXPECT_TRUE(fs::exists(at("a")));
  EXPECT_EQ(entries(), 1u);
}

TEST_F(FileTest, OldFileStaysWhenWritingFails) {
  writeWholeFile(at("a"), [](std::ostream& out) { out << "old"; });
  EXPECT_THROW(writeWholeFile(at("a"),
                              [](std::ostream& out) {
                                out << "new";
                                throw DataError("no");
                              }),
               DataError);
  std::string text;
  std::ifstream(at("a")) >> text;
  EXPECT_EQ(text, "old");
  EXPECT_EQ(entries(), 1u);
}

TEST_F(FileTest, FailedStreamIsAnError) {
  EXPECT_THROW(writeWholeFile(at("a"), [](std::ostream& out) { out.setstate(std::ios::badbit); }),
               FileError);
  EXPECT_EQ(entries(), 0u);
}

TEST_F(FileTest, UnwritablePlacesAreRefused) {
  EXPECT_THROW(PendingFile(at("no/such/folder")), FileError);
  EXPECT_THROW(PendingFile(folder_.string()), FileError);
  EXPECT_THROW(PendingFile(""), FileError);
  EXPECT_THROW(requireWritable(at("no/such/folder")), FileError);
  writeWholeFile(at("a"), [](std::ostream&) {});
  EXPECT_THROW(makeFolder(at("a")), FileError);
  EXPECT_NO_THROW(makeFolder(at("b/c/d")));
  EXPECT_TRUE(fs::is_directory(at("b/c/d")));
}

TEST_F(FileTest, AFolderOfFilesAppearsTogether) {
  const auto write = [](const std::string& path) {
    EXPECT_TRUE(fs::path(path).extension() == ".png" || fs::path(path).extension() == ".exr");
    writeWholeFile(path, [](std::ostream& out) { out << "x"; });
  };
  {
    PendingFolder folder(at("out"));
    folder.write("a.png", write);
    folder.write("b.exr", write);
    EXPECT_FALSE(fs::exists(at("out/a.png")));
  }
  EXPECT_FALSE(fs::exists(at("out"))) << "made here, so removed here";
  PendingFolder folder(at("out"));
  folder.write("a.png", write);
  folder.commit();
  EXPECT_TRUE(fs::exists(at("out/a.png")));
  EXPECT_THROW(PendingFolder(at("out/a.png")), FileError);
}

TEST_F(FileTest, ErrorsInAFolderNameTheFinalFile) {
  PendingFolder folder(at("out"));
  try {
    folder.write("a.png", [](const std::string& path) { throw FileError(path, "is bad"); });
    FAIL();
  } catch (const FileError& error) {
    EXPECT_EQ(error.what(), at("out/a.png") + ": is bad");
  }
}

TEST_F(FileTest, UnfinishedFilesCanBeRemovedAtOnce) {
  PendingFile file(at("a"));
  removeUnfinishedFiles();
  EXPECT_EQ(entries(), 0u);
}

}  // namespace
}  // namespace innermap
