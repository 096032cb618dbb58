#include "core/text_scanner.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>

#include "innermap/core/error.h"

namespace innermap {
namespace {

bool isSpace(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f'; }

// from_chars says "out of range" for numbers too small as well as for numbers too large; the small
// ones are zero for every purpose here.
bool underflows(std::string_view number) {
  if (number.find("e-") != number.npos || number.find("E-") != number.npos) return true;
  const std::size_t digit = number.find_first_not_of("+-0");
  return digit != number.npos && number[digit] == '.' && number.find_first_of("eE") == number.npos;
}

}  // namespace

std::string inQuotes(std::string_view text) {
  constexpr std::size_t kLongest = 40;
  std::string result(text.substr(0, kLongest));
  for (char& c : result)
    if (static_cast<unsigned char>(c) < 0x20 || static_cast<unsigned char>(c) > 0x7e) c = '?';
  return "'" + result + (text.size() > kLongest ? "...'" : "'");
}

bool equalsIgnoringCase(std::string_view a, std::string_view b) {
  const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; };
  return a.size() == b.size() && std::equal(a.begin(), a.end(), b.begin(),
                                            [&](char x, char y) { return lower(x) == lower(y); });
}

TextScanner::TextScanner(const FileBytes& file, TextSyntax syntax, std::size_t offset,
                         std::size_t firstLine)
    : file_(file), syntax_(syntax), line_(firstLine - 1) {
  next_ = file.bytes.data() + std::min(offset, file.bytes.size());
  end_ = file.bytes.data() + file.bytes.size();
  cursor_ = lineEnd_ = next_;
  // Old Mac files separate lines by carriage returns alone.
  if (!std::memchr(next_, '\n', static_cast<std::size_t>(end_ - next_))) separator_ = '\r';
}

bool TextScanner::nextLine() {
  if (next_ >= end_) {
    cursor_ = lineEnd_ = end_;
    return false;
  }
  ++line_;
  cursor_ = next_;
  const void* found = std::memchr(next_, separator_, static_cast<std::size_t>(end_ - next_));
  lineEnd_ = found ? static_cast<const char*>(found) : end_;
  next_ = found ? lineEnd_ + 1 : end_;
  return true;
}

bool TextScanner::continued() {
  const char* c = cursor_ + 1;
  while (c < lineEnd_ && isSpace(*c)) ++c;
  return c == lineEnd_;
}

bool TextScanner::token(std::string_view& token) {
  for (;;) {
    while (cursor_ < lineEnd_ && isSpace(*cursor_)) ++cursor_;
    if (cursor_ == lineEnd_) return false;
    if (syntax_.comments && *cursor_ == '#') {
      cursor_ = lineEnd_;
      return false;
    }
    if (!(syntax_.continuation && *cursor_ == '\\' && continued())) break;
    if (!nextLine()) return false;
  }
  const char* begin = cursor_++;
  while (cursor_ < lineEnd_ && !isSpace(*cursor_) && !(syntax_.comments && *cursor_ == '#') &&
         !(syntax_.continuation && *cursor_ == '\\' && continued()))
    ++cursor_;
  token = std::string_view(begin, static_cast<std::size_t>(cursor_ - begin));
  return true;
}

bool TextScanner::anyToken(std::string_view& result) {
  while (!token(result))
    if (!nextLine()) return false;
  return true;
}

bool TextScanner::nextFilledLine(std::string_view& result) {
  while (nextLine())
    if (token(result)) return true;
  return false;
}

std::size_t TextScanner::remainingBytes() const { return static_cast<std::size_t>(end_ - cursor_); }

void TextScanner::fail(const std::string& what) const {
  throw FileError(file_.path, fmt::format("line {}: {}", std::max<std::size_t>(1, line_), what));
}

double TextScanner::number(std::string_view token) const {
  const std::string_view digits = !token.empty() && token[0] == '+' ? token.substr(1) : token;
  double value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error == std::errc::invalid_argument || end != digits.data() + digits.size())
    fail(inQuotes(token) + " is not a number; correct the line or export the mesh again");
  if (error == std::errc::result_out_of_range && underflows(digits)) return 0;
  if (error != std::errc() || !std::isfinite(value))
    fail(inQuotes(token) + " is not a finite number; correct the line or export the mesh again");
  return value;
}

std::int64_t TextScanner::integer(std::string_view token) const {
  const std::string_view digits = !token.empty() && token[0] == '+' ? token.substr(1) : token;
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc() || end != digits.data() + digits.size())
    fail(inQuotes(token) + " is not a whole number; correct the line or export the mesh again");
  return value;
}

double TextScanner::nextNumber(const char* what) {
  std::string_view text;
  if (!token(text)) fail(std::string("the line ends before its ") + what);
  return number(text);
}

}  // namespace innermap
