// Lines, tokens and numbers of a text file held in memory, with errors that name
// the line. Independent of the locale.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "core/file_bytes.h"

namespace innermap {

// Text from a file made fit for a one-line message: shortened, unprintable bytes as '?'.
std::string inQuotes(std::string_view text);

// Whether two ASCII texts are equal but for their case.
bool equalsIgnoringCase(std::string_view a, std::string_view b);

struct TextSyntax {
  bool comments = false;      // '#' starts a comment
  bool continuation = false;  // '\' at the end of a line joins the next one to it
};

class TextScanner {
 public:
  // `file` must outlive the scanner. Starts at byte `offset`, which is in line `firstLine`.
  TextScanner(const FileBytes& file, TextSyntax syntax, std::size_t offset = 0,
              std::size_t firstLine = 1);

  // Goes to the next line; false at the end of the file.
  bool nextLine();

  // The next token of the line; false at its end.
  bool token(std::string_view& token);

  // The next token of this line or a later one; false at the end of the file.
  bool anyToken(std::string_view& token);

  // Goes to the next line that has a token and returns its first.
  bool nextFilledLine(std::string_view& token);

  std::size_t line() const { return line_; }
  std::size_t remainingBytes() const;

  // Throws FileError: "path: line 12: what".
  [[noreturn]] void fail(const std::string& what) const;

  // Throw FileError when the token is no number, not finite or out of range.
  double number(std::string_view token) const;
  std::int64_t integer(std::string_view token) const;

  // The line's next token, which must be there and be a finite number (`what` names it).
  double nextNumber(const char* what);

 private:
  bool continued();

  const FileBytes& file_;
  TextSyntax syntax_;
  const char *cursor_, *lineEnd_, *next_, *end_;
  char separator_ = '\n';
  std::size_t line_;
};

}  // namespace innermap
