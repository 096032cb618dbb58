// Where a reader of Gmsh's files stands: words of text, and numbers that are text or binary.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "core/file_bytes.h"

namespace innermap {

class MshCursor {
 public:
  explicit MshCursor(const FileBytes& file) : file_(file) {}  // which must outlive it

  void setBinary() { binary_ = true; }
  bool binary() const { return binary_; }
  std::size_t position() const { return position_; }

  // The next word of text; false at the end of the file.
  bool word(std::string_view& word);
  std::string_view nextWord();
  std::string quoted();  // a text in quotes, or a word
  // Text also in binary files.
  std::int64_t textInteger();
  double textReal();
  void endLine();  // goes behind the line's end

  // Numbers of a section's body.
  std::int64_t integer();  // int, 4 bytes
  std::int64_t size();     // size_t, 8 bytes
  double real();           // double, 8 bytes
  // Four bytes of a binary file as they are.
  std::int64_t rawInteger();

  // Goes behind the next "$End..." of the section; a section of binary data may hold anything.
  void skipSection(std::string_view name);

  // Throws FileError unless so many items can be in what is left, each of so many numbers of the
  // given bytes in all when binary.
  void requireRoom(std::int64_t count, int numbers, int bytes) const;

  [[noreturn]] void fail(const std::string& what) const;  // FileError with the line or byte

 private:
  void take(char* out, std::size_t size);

  const FileBytes& file_;
  std::size_t position_ = 0;
  bool binary_ = false;
};

}  // namespace innermap
