#include "core/file.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "core/expect.h"
#include "core/temporary_folder.h"
#include "innermap/core/error.h"

namespace innermap {
namespace {

namespace fs = std::filesystem;

class FileTest : public ::testing::Test {
 protected:
  std::string at(const std::string& name) const { return folder_.file(name); }
  std::size_t entries() const { return folder_.count(); }
  test::TemporaryFolder folder_;
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
  EXPECT_THROW(PendingFile(folder_.path().string()), FileError);
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

TEST_F(FileTest, AFolderIsAllNewOrAllOld) {
  const auto put = [&](const char* text) {
    PendingFolder folder(at("out"));
    for (const char* name : {"a", "b", "c"})
      folder.write(name, [&](const std::string& path) {
        writeWholeFile(path, [&](std::ostream& out) { out << text; });
      });
    // Comes between: the name is free when the file is written, taken when it is put in place.
    if (std::string(text) == "new") {
      fs::remove(at("out/c"));
      fs::create_directory(at("out/c"));
    }
    folder.commit();
  };
  put("old");
  EXPECT_THROW(put("new"), FileError);
  for (const char* name : {"out/a", "out/b"}) {
    std::string text;
    std::ifstream(at(name)) >> text;
    EXPECT_EQ(text, "old") << name;
  }
  EXPECT_EQ(std::distance(fs::directory_iterator(at("out")), fs::directory_iterator()), 3);
}

TEST_F(FileTest, LinksAreFollowedAndPipesStay) {
  fs::create_symlink("real", at("link"));
  for (const char* text : {"one", "two"}) {
    writeWholeFile(at("link"), [&](std::ostream& out) { out << text; });
    EXPECT_TRUE(fs::is_symlink(at("link")));
    std::string found;
    std::ifstream(at("real")) >> found;
    EXPECT_EQ(found, text);
  }
  ASSERT_EQ(mkfifo(at("pipe").c_str(), 0600), 0);
  fs::create_symlink("pipe", at("to_pipe"));
  const int reader = open(at("pipe").c_str(), O_RDWR);
  EXPECT_NO_THROW(requireWritable(at("to_pipe")));
  EXPECT_NO_THROW(writeWholeFile(at("to_pipe"), [](std::ostream& out) { out << "xyz"; }));
  char got[8] = {};
  EXPECT_EQ(read(reader, got, sizeof got), 3);
  close(reader);
  EXPECT_STREQ(got, "xyz");
  EXPECT_TRUE(fs::is_fifo(at("pipe")));
  fs::create_symlink("circle", at("circle"));
  EXPECT_THROW(requireWritable(at("circle")), FileError);
}

TEST_F(FileTest, OneFileHasOneKey) {
  writeWholeFile(at("a"), [](std::ostream&) {});
  fs::create_symlink("a", at("soft"));
  fs::create_hard_link(at("a"), at("hard"));
  fs::create_symlink("none", at("dangling"));
  for (const char* name : {"soft", "hard", "./a"}) EXPECT_TRUE(isSameFile(at("a"), at(name)));
  EXPECT_TRUE(isSameFile(at("none"), at("dangling")));
  EXPECT_TRUE(isSameFile(at("no/where"), at("no/./where")));
  EXPECT_FALSE(isSameFile(at("none"), at("a")));
  EXPECT_FALSE(isSameFile(at("none"), at("other")));
  EXPECT_FALSE(isSameFile("/dev/null", "/dev/null"));
}

TEST_F(FileTest, WordsForWhatCannotBeWritten) {
  const auto said = [](const std::string& path) {
    return test::refusalOf<FileError>([&] { requireWritable(path); });
  };
  EXPECT_NE(said(at("no/file")).find("does not exist; make it"), std::string::npos);
  writeWholeFile(at("a"), [](std::ostream&) {});
  EXPECT_NE(said(at("a/file")).find("is a file, not a folder"), std::string::npos);
  EXPECT_EQ(said(at(std::string(255, 'n'))), "accepted");
  EXPECT_NE(said(at(std::string(256, 'n'))).find("256 bytes"), std::string::npos);
}

TEST_F(FileTest, WhatOthersLeftGoesButWhatIsInUseStays) {
  const PendingFile mine(at("a"));
  const std::string left = mine.temporaryPath() + "x";
  std::ofstream(left) << "left";
  const PendingFile second(at("a"));
  EXPECT_FALSE(fs::exists(left));
  EXPECT_TRUE(fs::exists(mine.temporaryPath()));
}

TEST_F(FileTest, WhatIsNoLongerThereGoesWithTheCommit) {
  fs::create_directories(at("out"));
  std::ofstream(at("out/stale")) << "old";
  {
    PendingFolder folder(at("out"));
    folder.remove("stale");
    folder.remove("missing");
  }
  fs::create_directories(at("out/folder"));
  fs::create_symlink(at("elsewhere"), at("out/link"));
  std::ofstream(at("elsewhere")) << "kept";
  EXPECT_TRUE(fs::exists(at("out/stale")));  // there was no commit
  PendingFolder folder(at("out"));
  folder.write("new", [&](const std::string& path) { std::ofstream(path) << "new"; });
  for (const char* name : {"stale", "folder", "link"}) folder.remove(name);
  EXPECT_EQ(folder.written().size(), 1u);
  folder.commit();
  EXPECT_TRUE(fs::exists(at("out/folder")) && fs::exists(at("out/link")) &&
              fs::exists(at("elsewhere")));
  EXPECT_FALSE(fs::exists(at("out/stale")));
  EXPECT_TRUE(fs::exists(at("out/new")));
}

TEST_F(FileTest, ACommitThatWasCutOffIsFinished) {
  std::string staging;
  {
    PendingFolder folder(at("out"));
    folder.write("a", [&](const std::string& path) {
      staging = fs::path(path).parent_path().parent_path().string();
      writeWholeFile(path, [](std::ostream& out) { out << "old"; });
    });
    folder.commit();
  }
  // As after a kill between two renames.
  for (const char* part : {"/new", "/replaced"}) fs::create_directories(staging + part);
  std::ofstream(staging + "/new/a") << "new";
  { const PendingFolder next(at("out")); }
  std::string text;
  std::ifstream(at("out/a")) >> text;
  EXPECT_EQ(text, "new");
  EXPECT_FALSE(fs::exists(staging));
}

TEST_F(FileTest, UnfinishedFoldersGoWithWhatTheyHold) {
  PendingFolder folder(at("one/two"));
  folder.write("a", [](const std::string& path) { std::ofstream(path) << "x"; });
  removeUnfinishedFiles();
  EXPECT_EQ(entries(), 0u);
}

TEST_F(FileTest, ErrorsInAFolderNameTheFinalFile) {
  PendingFolder folder(at("out"));
  const auto fails = [](const std::string& path) { throw FileError(path, "is bad"); };
  EXPECT_EQ(test::refusalOf<FileError>([&] { folder.write("a.png", fails); }),
            at("out/a.png") + ": is bad");
}

TEST_F(FileTest, UnfinishedFilesCanBeRemovedAtOnce) {
  PendingFile file(at("a"));
  removeUnfinishedFiles();
  EXPECT_EQ(entries(), 0u);
}

}  // namespace
}  // namespace innermap
