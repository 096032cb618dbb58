// The files of an animation: one a frame, with the frame's number in the name.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace innermap {

struct FrameFile {
  std::int64_t number = 0;
  std::string path;
};

// A frame of an animation that was worked on.
struct FrameResult {
  FrameFile file;
  double seconds = 0;
  std::string error;  // empty: good
};

// The last run of digits in the file's name before its extension: 12 for "walk_v2.0012.obj". A
// minus sign counts behind a dot, an underscore or nothing ("walk.-0003.obj"). None without digits
// and for numbers over 15 digits.
std::optional<std::int64_t> frameNumber(const std::string& path);

struct FrameList {
  std::vector<FrameFile> frames;        // ascending numbers, each once
  std::vector<std::string> unnumbered;  // files of folders and patterns that have no number
};

// Each of `arguments` is a file, a folder (its files with one of `extensions`, such as ".obj", in
// any case), or a pattern: * and ? as in a shell, in folders' names too, and in the file's name
// #### or %04d for the number, four digits or more with leading zeros. Without those two the number
// is frameNumber's.
// Throws FileError when an argument names nothing, when a file given by name has no number, or when
// two files have the same number.
FrameList findFrames(const std::vector<std::string>& arguments,
                     const std::vector<std::string>& extensions);

// Which frames: "12", "1-48", "1-48x2" (every second), several with commas; numbers may be
// negative ("-10--5").
class FrameRanges {
 public:
  // Throws SettingError naming `setting` for what is not such a text.
  FrameRanges(const std::string& setting, const std::string& text);

  bool contains(std::int64_t number) const;

 private:
  struct Range {
    std::int64_t first = 0, last = 0, step = 1;
  };
  std::vector<Range> ranges_;
};

// Where the result of each frame goes.
class FramePattern {
 public:
  // A path whose file's name has #### (any number of them) or %04d for the number; without, the
  // number is put before the extension, padded to four digits: "out/a.vdb" gives "out/a.0012.vdb".
  // Throws SettingError naming `setting` when the name is empty or has two such places.
  FramePattern(const std::string& setting, const std::string& text);

  std::string path(std::int64_t number) const;
  const std::string& folder() const { return folder_; }  // "." for the current one

 private:
  std::string folder_, before_, after_;
  int width_ = 4;
};

}  // namespace innermap
