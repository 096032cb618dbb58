#include "core/frame_files.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "core/expect.h"
#include "core/temporary_folder.h"
#include "innermap/core/error.h"

namespace innermap {
namespace {

namespace fs = std::filesystem;

// An empty folder with the files named, as the current one while it lives.
class Files {
 public:
  explicit Files(const std::vector<std::string>& names) : before_(fs::current_path()) {
    for (const std::string& name : names) {
      fs::create_directories(fs::path(folder_.file(name)).parent_path());
      folder_.write(name, "x");
    }
    fs::current_path(folder_.path());
  }
  ~Files() { fs::current_path(before_); }

 private:
  fs::path before_;
  test::TemporaryFolder folder_;
};

std::string found(const std::vector<std::string>& arguments) {
  std::string text;
  for (const FrameFile& f : findFrames(arguments, {".obj", ".ply"}).frames)
    text += (text.empty() ? "" : " ") + std::to_string(f.number) + ":" + f.path;
  return text;
}

std::string refusal(const std::vector<std::string>& arguments) {
  return test::refusalOf<FileError>([&] { found(arguments); });
}

TEST(FrameNumber, IsTheLastOfTheName) {
  EXPECT_EQ(frameNumber("frame.0012.obj"), 12);
  EXPECT_EQ(frameNumber("shots/12/walk_v2.0003.obj"), 3);
  EXPECT_EQ(frameNumber("walk0040_final.ply"), 40);
  EXPECT_EQ(frameNumber("12.obj"), 12);
  EXPECT_EQ(frameNumber("a.-0003.obj"), -3);
  EXPECT_EQ(frameNumber("-3.obj"), -3);
  EXPECT_EQ(frameNumber("take-3.obj"), 3);
  EXPECT_EQ(frameNumber("a.000000000000012.obj"), 12);
  EXPECT_FALSE(frameNumber("rest.obj"));
  EXPECT_EQ(frameNumber("12/rest.mp4.obj"), 4);
  EXPECT_FALSE(frameNumber("a.1234567890123456.obj"));
}

TEST(FindFrames, SortsByNumberNotByName) {
  const Files files({"f.10.obj", "f.9.obj", "f.100.obj", "rest.obj", "f.9.txt", ".f.7.obj"});
  EXPECT_EQ(found({"*.obj"}), "9:f.9.obj 10:f.10.obj 100:f.100.obj");
  EXPECT_EQ(found({"f.##.obj"}), "10:f.10.obj 100:f.100.obj");
  EXPECT_EQ(found({"f.100.obj", "f.9.obj"}), "9:f.9.obj 100:f.100.obj");
  EXPECT_EQ(found({"f.9.obj", "f.?.obj"}), "9:f.9.obj");
  EXPECT_EQ(findFrames({"*.obj"}, {}).unnumbered, std::vector<std::string>{"rest.obj"});
}

TEST(FindFrames, PlacesForTheNumber) {
  const Files files({"a/s1.0001.v2.obj", "a/s1.0002.v2.obj", "a/s1.-003.v2.obj",
                     "a/s1.10000.v2.obj", "a/s1.00003.v2.obj", "a/s1.5.v2.obj",
                     "b/s2.0007.v1.obj"});
  const std::string four =
      "-3:a/s1.-003.v2.obj 1:a/s1.0001.v2.obj 2:a/s1.0002.v2.obj 10000:a/s1.10000.v2.obj";
  EXPECT_EQ(found({"a/s1.####.v2.obj"}), four);
  EXPECT_EQ(found({"a/s1.%04d.v2.obj"}), four);
  EXPECT_EQ(found({"a/s1.%d.v2.obj"}), "5:a/s1.5.v2.obj 10000:a/s1.10000.v2.obj");
  EXPECT_EQ(found({"?/*.####.*.obj"}),
            four.substr(0, 57) + " 7:b/s2.0007.v1.obj" + four.substr(57));
  // The last number is that of the version.
  EXPECT_NE(refusal({"a/*.obj"}).find("number 2"), std::string::npos);
}

TEST(FindFrames, Folders) {
  const Files files(
      {"in/f.2.obj", "in/f.1.PLY", "in/f.3.txt", "in/rest.obj", "in/.f.4.obj", "empty/readme.txt"});
  EXPECT_EQ(found({"in"}), "1:in/f.1.PLY 2:in/f.2.obj");
  EXPECT_EQ(found({"i*/*.obj"}), "2:in/f.2.obj");
  EXPECT_NE(refusal({"empty"}).find("empty"), std::string::npos);
}

TEST(FindFrames, RefusesWithTheArgumentsName) {
  const Files files({"f.1.obj", "f.01.obj", "rest.obj", "[a]*.3.obj"});
  EXPECT_NE(refusal({"g.*.obj"}).find("g.*.obj: "), std::string::npos);
  EXPECT_NE(refusal({"g/####.obj"}).find("g/####.obj"), std::string::npos);
  EXPECT_NE(refusal({"g.1.obj"}).find("g.1.obj: "), std::string::npos);
  EXPECT_NE(refusal({"rest.obj"}).find("rest.obj: "), std::string::npos);
  const std::string twice = refusal({"f.*.obj"});
  EXPECT_NE(twice.find("f.1.obj"), std::string::npos) << twice;
  EXPECT_NE(twice.find("f.01.obj"), std::string::npos) << twice;
  // A file's own name comes before what it means as a pattern.
  EXPECT_EQ(found({"[a]*.3.obj"}), "3:[a]*.3.obj");
}

TEST(FrameRanges, Contain) {
  const FrameRanges ranges("--frames", "-4--2,1-9x3,20");
  std::string in;
  for (int n = -6; n < 25; ++n)
    if (ranges.contains(n)) in += std::to_string(n) + " ";
  EXPECT_EQ(in, "-4 -3 -2 1 4 7 20 ");
  for (const char* text : {"", "a", "1-", "5-3", "1-5x0", "1-5x", "1,", "1 - 5", "1-5x2x2", "--1",
                           "99999999999999999999"})
    EXPECT_THROW(FrameRanges("--frames", text), SettingError) << text;
  EXPECT_TRUE(FrameRanges("f", "-9223372036854775808-9223372036854775807x3").contains(1));
}

TEST(FramePattern, KeepsTheNumber) {
  EXPECT_EQ(FramePattern("-o", "out/a.####.vdb").path(12), "out/a.0012.vdb");
  EXPECT_EQ(FramePattern("-o", "out/a.####.vdb").path(123456), "out/a.123456.vdb");
  EXPECT_EQ(FramePattern("-o", "out/a.####.vdb").path(-3), "out/a.-003.vdb");
  EXPECT_EQ(FramePattern("-o", "a_%06d.vdb").path(12), "a_000012.vdb");
  EXPECT_EQ(FramePattern("-o", "a_#.vdb").path(-3), "a_-3.vdb");
  EXPECT_EQ(FramePattern("-o", "a%d").path(3), "a3");
  EXPECT_EQ(FramePattern("-o", "out/a.vdb").path(12), "out/a.0012.vdb");
  EXPECT_EQ(FramePattern("-o", "v#/a.vdb").path(1), "v#/a.0001.vdb");
  EXPECT_EQ(FramePattern("-o", "/x/y/a.vdb").folder(), "/x/y");
  EXPECT_EQ(FramePattern("-o", "a.vdb").folder(), ".");
  EXPECT_THROW(FramePattern("-o", "a.##.##.vdb"), SettingError);
  EXPECT_THROW(FramePattern("-o", "a/"), SettingError);
  EXPECT_THROW(FramePattern("-o", ""), SettingError);
}

TEST(FramePattern, WhatItWritesIsFoundAgain) {
  for (const char* text : {"a.####.vdb", "a.%03d.vdb", "a.#.vdb"})
    for (const std::int64_t number : {-12345, -12, -1, 0, 7, 999, 1000, 123456}) {
      const std::string path = FramePattern("-o", text).path(number);
      const Files files({path});
      EXPECT_EQ(found({text}), std::to_string(number) + ":" + path);
      EXPECT_EQ(frameNumber(path), number);
    }
}

}  // namespace
}  // namespace innermap
