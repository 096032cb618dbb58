#include "core/text_scanner.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>

#include "innermap/core/error.h"

namespace innermap {
namespace {

enum : unsigned char { kSpace = 1, kComment = 2, kContinuation = 4 };

constexpr std::array<unsigned char, 256> kClasses = [] {
  std::array<unsigned char, 256> classes{};
  for (const unsigned char c : {' ', '\t', '\r', '\v', '\f'}) classes[c] = kSpace;
  classes['#'] = kComment;
  classes['\\'] = kContinuation;
  return classes;
}();

unsigned char classOf(char c) { return kClasses[static_cast<unsigned char>(c)]; }

// from_chars says "out of range" for numbers too small as well as for numbers too large; the small
// ones are zero for every purpose here.
bool underflows(std::string_view number) {
  if (number.find("e-") != number.npos || number.find("E-") != number.npos) return true;
  const std::size_t digit = number.find_first_not_of("+-0");
  return digit != number.npos && number[digit] == '.' && number.find_first_of("eE") == number.npos;
}

// Old Mac files separate lines by carriage returns alone.
char separatorOf(const FileBytes& file, std::size_t from) {
  return file.bytes.find('\n', from) == file.bytes.npos ? '\r' : '\n';
}

template <class Number>
std::errc parse(std::string_view text, Number& value) {
  if (!text.empty() && text[0] == '+') text.remove_prefix(1);
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  return stop == end ? error : std::errc::invalid_argument;
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

std::optional<double> parseNumber(std::string_view text) {
  double value = 0;
  const std::errc error = parse(text, value);
  if (error == std::errc::result_out_of_range)
    return underflows(text) ? 0 : std::numeric_limits<double>::infinity();
  return error == std::errc() ? std::optional(value) : std::nullopt;
}

std::optional<std::int64_t> parseInteger(std::string_view text) {
  std::int64_t value = 0;
  return parse(text, value) == std::errc() ? std::optional(value) : std::nullopt;
}

void failAt(const FileBytes& file, std::size_t byte, const std::string& what) {
  // The end of the file belongs to its last line.
  const std::size_t before = std::min(byte, std::max<std::size_t>(1, file.bytes.size()) - 1);
  const auto lines =
      std::count(file.bytes.begin(), file.bytes.begin() + static_cast<std::ptrdiff_t>(before),
                 separatorOf(file, 0));
  throw FileError(file.path, fmt::format("line {}: {}", lines + 1, what));
}

TextScanner::TextScanner(const FileBytes& file, TextSyntax syntax, std::size_t offset)
    : file_(file),
      special_(static_cast<unsigned char>(kSpace | (syntax.comments ? kComment : 0) |
                                          (syntax.continuation ? kContinuation : 0))),
      end_(file.bytes.data() + file.bytes.size()) {
  seek(offset);
  separator_ = separatorOf(file, offset);
}

void TextScanner::seek(std::size_t byte) {
  cursor_ = lineEnd_ = next_ = file_.bytes.data() + std::min(byte, file_.bytes.size());
}

bool TextScanner::nextLine() {
  lineBegin_ = endLine();
  return breakLine();
}

std::size_t TextScanner::endLine() {
  if ((special_ & kContinuation) && cursor_ < lineEnd_ &&
      std::memchr(cursor_, '\\', static_cast<std::size_t>(lineEnd_ - cursor_)))
    for (std::string_view rest; token(rest);) {
    }
  cursor_ = lineEnd_;
  return static_cast<std::size_t>(next_ - file_.bytes.data());
}

bool TextScanner::breakLine() {
  if (next_ >= end_) {
    cursor_ = lineEnd_ = end_;
    return false;
  }
  cursor_ = next_;
  const void* found = std::memchr(next_, separator_, static_cast<std::size_t>(end_ - next_));
  lineEnd_ = found ? static_cast<const char*>(found) : end_;
  next_ = found ? lineEnd_ + 1 : end_;
  return true;
}

bool TextScanner::joins(const char* at) const {
  if (*at != '\\') return false;
  ++at;
  while (at < lineEnd_ && classOf(*at) == kSpace) ++at;
  return at == lineEnd_;
}

bool TextScanner::token(std::string_view& token) {
  for (;;) {
    while (cursor_ < lineEnd_ && classOf(*cursor_) == kSpace) ++cursor_;
    if (cursor_ == lineEnd_) return false;
    const unsigned char kind = classOf(*cursor_) & special_;
    if (kind == kComment) {
      cursor_ = lineEnd_;
      return false;
    }
    if (kind != kContinuation || !joins(cursor_)) break;
    if (!breakLine()) return false;
  }
  const char *const begin = cursor_, *at = begin + 1, *const end = lineEnd_;
  while (at < end && (!(classOf(*at) & special_) || (*at == '\\' && !joins(at)))) ++at;
  cursor_ = at;
  token = std::string_view(begin, static_cast<std::size_t>(at - begin));
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

void TextScanner::fail(const std::string& what) const { failAt(file_, position(), what); }

double TextScanner::number(std::string_view token) const {
  const std::optional<double> value = parseNumber(token);
  if (!value || !std::isfinite(*value))
    fail(inQuotes(token) + " is not a finite number; correct the line or export the file again");
  return *value;
}

std::int64_t TextScanner::integer(std::string_view token) const {
  const std::optional<std::int64_t> value = parseInteger(token);
  if (!value)
    fail(inQuotes(token) + " is not a whole number; correct the line or export the file again");
  return *value;
}

double TextScanner::nextNumber(const char* what) {
  std::string_view text;
  if (!token(text)) fail(std::string("the line ends before its ") + what);
  return number(text);
}

Vec3 TextScanner::nextVec3(const char* what) {
  Vec3 p;
  for (int a = 0; a < 3; ++a) p[a] = nextNumber(what);
  return p;
}

}  // namespace innermap
