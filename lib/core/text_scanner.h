// Lines, tokens and numbers of a text file held in memory, with errors that name
// the line. Independent of the locale.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "core/file_bytes.h"
#include "innermap/core/vec3.h"

namespace innermap {

// Text from a file made fit for a one-line message: shortened, unprintable bytes as '?'.
std::string inQuotes(std::string_view text);

// Whether two ASCII texts are equal but for their case.
bool equalsIgnoringCase(std::string_view a, std::string_view b);

// What all of the text says, before which may stand a '+'; nothing where it is no number. Numbers
// that are too large are infinite, those too small zero.
std::optional<double> parseNumber(std::string_view text);
std::optional<std::int64_t> parseInteger(std::string_view text);

// Throws FileError: "path: line 12: what", the line being that of the byte.
[[noreturn]] void failAt(const FileBytes& file, std::size_t byte, const std::string& what);

struct TextSyntax {
  bool comments = false;      // '#' starts a comment
  bool continuation = false;  // '\' at the end of a line joins the next one to it
};

class TextScanner {
 public:
  // `file` must outlive the scanner. Starts at byte `offset`.
  TextScanner(const FileBytes& file, TextSyntax syntax, std::size_t offset = 0);

  // Goes to the next line; false at the end of the file. Lines that are joined are one.
  bool nextLine();

  // The next token of the line; false at its end.
  bool token(std::string_view& token);

  // The next token of this line or a later one; false at the end of the file.
  bool anyToken(std::string_view& token);

  // Goes to the next line that has a token and returns its first.
  bool nextFilledLine(std::string_view& token);

  const FileBytes& file() const { return file_; }
  // Bytes of the file: behind the last token, and where this line begins.
  std::size_t position() const { return static_cast<std::size_t>(cursor_ - file_.bytes.data()); }
  std::size_t lineBegin() const { return lineBegin_; }
  std::size_t remainingBytes() const { return static_cast<std::size_t>(end_ - cursor_); }

  // Goes to the line's end; returns the byte behind its line break.
  std::size_t endLine();
  // Goes to a byte, which counts as the beginning of a line.
  void seek(std::size_t byte);

  // Throws FileError with the line.
  [[noreturn]] void fail(const std::string& what) const;

  // Throw FileError when the token is no number, not finite or out of range.
  double number(std::string_view token) const;
  std::int64_t integer(std::string_view token) const;

  // The line's next token, which must be there and be a finite number (`what` names it).
  double nextNumber(const char* what);
  Vec3 nextVec3(const char* what);

 private:
  bool breakLine();
  bool joins(const char* at) const;

  const FileBytes& file_;
  unsigned char special_;  // classes of characters that end a token or may do so
  const char *cursor_, *lineEnd_, *next_, *end_;
  char separator_ = '\n';
  std::size_t lineBegin_ = 0;
};

}  // namespace innermap
