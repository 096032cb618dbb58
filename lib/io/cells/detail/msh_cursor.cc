#include "io/cells/detail/msh_cursor.h"

#include <fmt/format.h>

#include <cstring>

#include "core/text_scanner.h"
#include "innermap/core/error.h"
#include "io/cells/detail/cell_formats.h"

namespace innermap {
namespace {

bool isSpace(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }

}  // namespace

void MshCursor::fail(const std::string& what) const {
  if (binary_) throw FileError(file_.path, fmt::format("byte {}: {}", position_, what));
  failAt(file_, position_, what);
}

bool MshCursor::word(std::string_view& word) {
  const std::string& bytes = file_.bytes;
  while (position_ < bytes.size() && isSpace(bytes[position_])) ++position_;
  const std::size_t begin = position_;
  while (position_ < bytes.size() && !isSpace(bytes[position_])) ++position_;
  word = std::string_view(bytes).substr(begin, position_ - begin);
  return !word.empty();
}

std::string_view MshCursor::nextWord() {
  std::string_view text;
  if (!word(text)) fail("the file ends too early; export it again");
  return text;
}

std::string MshCursor::quoted() {
  const std::string& bytes = file_.bytes;
  while (position_ < bytes.size() && isSpace(bytes[position_])) ++position_;
  if (position_ >= bytes.size() || bytes[position_] != '"') return std::string(nextWord());
  const std::size_t close = bytes.find('"', position_ + 1);
  if (close == bytes.npos) fail("a text in quotes does not end");
  std::string text = bytes.substr(position_ + 1, close - position_ - 1);
  position_ = close + 1;
  return text;
}

std::int64_t MshCursor::textInteger() {
  const std::string_view text = nextWord();
  const std::optional<std::int64_t> value = parseInteger(text);
  if (!value) fail(inQuotes(text) + " is not a whole number; export the file again");
  return *value;
}

double MshCursor::textReal() {
  const std::string_view text = nextWord();
  const std::optional<double> value = parseNumber(text);
  if (!value) fail(inQuotes(text) + " is not a number; export the file again");
  return *value;
}

void MshCursor::endLine() {
  const std::size_t end = file_.bytes.find('\n', position_);
  position_ = end == file_.bytes.npos ? file_.bytes.size() : end + 1;
}

void MshCursor::take(char* out, std::size_t size) {
  if (size > file_.bytes.size() - position_) fail("the file ends too early; export it again");
  std::memcpy(out, file_.bytes.data() + position_, size);
  position_ += size;
}

std::int64_t MshCursor::rawInteger() {
  std::int32_t value = 0;
  take(reinterpret_cast<char*>(&value), sizeof value);
  return value;
}

std::int64_t MshCursor::integer() { return binary_ ? rawInteger() : textInteger(); }

std::int64_t MshCursor::size() {
  if (!binary_) return textInteger();
  std::int64_t value = 0;
  take(reinterpret_cast<char*>(&value), sizeof value);
  return value;
}

double MshCursor::real() {
  if (!binary_) return textReal();
  double value = 0;
  take(reinterpret_cast<char*>(&value), sizeof value);
  return value;
}

void MshCursor::skipSection(std::string_view name) {
  const std::string end = "$End" + std::string(name.substr(1));
  const std::size_t found = file_.bytes.find(end, position_);
  if (found == file_.bytes.npos) fail("the section " + inQuotes(name) + " does not end");
  position_ = found + end.size();
}

void MshCursor::requireRoom(std::int64_t count, int numbers, int bytes) const {
  const auto left = static_cast<std::int64_t>(file_.bytes.size() - position_);
  const std::int64_t each = binary_ ? bytes : 2 * numbers;
  if (count < 0 || count > (left + 1) / each)
    fail(
        fmt::format("{} items do not fit in the {} bytes left; the file is cut short or its "
                    "counts are wrong",
                    count, left));
}

}  // namespace innermap
