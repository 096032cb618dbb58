#include "io/geometry/detail/geometry_formats.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

#include "core/text_scanner.h"
#include "innermap/core/error.h"

namespace innermap {
namespace {

bool isSpace(char c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '\v' || c == '\f';
}

// Whether only blanks follow until the line ends.
bool endsLine(const std::string& bytes, std::size_t at, std::size_t end) {
  while (at < end && (bytes[at] == ' ' || bytes[at] == '\t' || bytes[at] == '\r')) ++at;
  return at >= end || bytes[at] == '\n';
}

}  // namespace

bool LineWords::separates(std::size_t at) const {
  return isSpace((*bytes_)[at]) || ((*bytes_)[at] == '\\' && endsLine(*bytes_, at + 1, end_));
}

bool LineWords::next(std::string_view& word) {
  while (position_ < end_ && separates(position_)) ++position_;
  if (position_ < end_ && comments_ && (*bytes_)[position_] == '#') {
    end_ = position_;
    return false;
  }
  const std::size_t begin = position_;
  while (position_ < end_ && !separates(position_) && !(comments_ && (*bytes_)[position_] == '#'))
    ++position_;
  word = std::string_view(*bytes_).substr(begin, position_ - begin);
  return !word.empty();
}

TextLines::TextLines(const FileBytes& file, bool continued, std::size_t begin)
    : bytes_(file.bytes), continued_(continued), position_(begin) {
  if (bytes_.find('\n', begin) == bytes_.npos) separator_ = '\r';
}

bool TextLines::next(std::size_t& begin, std::size_t& end) {
  if (position_ >= bytes_.size()) return false;
  line_ = nextLine_;
  begin = end = position_;
  for (;;) {
    const std::size_t found = bytes_.find(separator_, end);
    const std::size_t stop = found == bytes_.npos ? bytes_.size() : found + 1;
    ++nextLine_;
    std::size_t last = found == bytes_.npos ? bytes_.size() : found;
    while (last > end && isSpace(bytes_[last - 1])) --last;
    const bool more = continued_ && last > end && bytes_[last - 1] == '\\';
    end = stop;
    if (!more || end >= bytes_.size()) break;
  }
  position_ = end;
  return true;
}

void failAtLine(const FileBytes& file, std::size_t line, const std::string& what) {
  throw FileError(file.path, fmt::format("line {}: {}", line, what));
}

double numberOf(const FileBytes& file, std::size_t line, std::string_view word) {
  const std::string_view digits = !word.empty() && word[0] == '+' ? word.substr(1) : word;
  double value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (end != digits.data() + digits.size() || error == std::errc::invalid_argument ||
      (error == std::errc() && !std::isfinite(value)))
    failAtLine(file, line, inQuotes(word) + " is not a finite number; export the file again");
  // Out of range: tiny ones are 0 here.
  if (error == std::errc::result_out_of_range && digits.find("e-") == digits.npos &&
      digits.find("E-") == digits.npos)
    failAtLine(file, line, inQuotes(word) + " is not a finite number; export the file again");
  return value;
}

std::int64_t integerOf(const FileBytes& file, std::size_t line, std::string_view word) {
  const std::string_view digits = !word.empty() && word[0] == '+' ? word.substr(1) : word;
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc() || end != digits.data() + digits.size())
    failAtLine(file, line, inQuotes(word) + " is not a whole number; export the file again");
  return value;
}

void requireCountable(const FileBytes& file, std::size_t count, const char* what) {
  if (count >= static_cast<std::size_t>(std::numeric_limits<int>::max()))
    throw FileError(file.path,
                    fmt::format("has over 2147483646 {}; cut the file into parts", what));
}

}  // namespace innermap
