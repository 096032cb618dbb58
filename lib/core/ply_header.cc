#include "core/ply_header.h"

#include <fmt/format.h>

#include <utility>

#include "innermap/core/error.h"

namespace innermap {
namespace {

bool findType(std::string_view name, PlyType& type) {
  static const std::pair<const char*, PlyType> kNames[] = {
      {"char", PlyType::int8},      {"int8", PlyType::int8},       {"uchar", PlyType::uint8},
      {"uint8", PlyType::uint8},    {"short", PlyType::int16},     {"int16", PlyType::int16},
      {"ushort", PlyType::uint16},  {"uint16", PlyType::uint16},   {"int", PlyType::int32},
      {"int32", PlyType::int32},    {"uint", PlyType::uint32},     {"uint32", PlyType::uint32},
      {"float", PlyType::float32},  {"float32", PlyType::float32}, {"double", PlyType::float64},
      {"float64", PlyType::float64}};
  for (const auto& [known, value] : kNames)
    if (name == known) {
      type = value;
      return true;
    }
  return false;
}

class HeaderReader {
 public:
  explicit HeaderReader(const FileBytes& file) : file_(file) {}

  PlyHeader read() {
    if (!nextLine() || words_.size() != 1 || words_[0] != "ply")
      fail("a PLY file begins with a line 'ply'; give a PLY file");
    while (nextLine()) {
      if (words_.empty() || words_[0] == "comment" || words_[0] == "obj_info") continue;
      if (words_[0] == "end_header") return finish();
      if (words_[0] == "format")
        format();
      else if (words_[0] == "element")
        element();
      else if (words_[0] == "property")
        property();
      else
        fail(inQuotes(words_[0]) + " is no keyword of a PLY header");
    }
    fail("the header has no end_header; the file is cut short or not a PLY file");
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw FileError(file_.path, fmt::format("line {}: {}", line_ ? line_ : 1, what));
  }

  // A line ends with \n, \r\n or \r, the same all over the header: in a binary file the body's
  // first byte must not be taken for a part of the last line's end.
  bool nextLine() {
    const std::string& bytes = file_.bytes;
    if (position_ >= bytes.size()) return false;
    std::size_t end = bytes.find_first_of("\r\n", position_);
    if (ending_ == 0 && end != bytes.npos)
      ending_ = bytes[end] == '\r' && bytes.compare(end, 2, "\r\n") == 0 ? 2 : 1;
    if (end == bytes.npos) end = bytes.size();
    ++line_;
    const std::string_view line(bytes.data() + position_, end - position_);
    position_ = std::min(bytes.size(), end + ending_);
    words_.clear();
    for (std::size_t at = 0; (at = line.find_first_not_of(" \t", at)) != line.npos;) {
      const std::size_t stop = std::min(line.find_first_of(" \t", at), line.size());
      words_.push_back(line.substr(at, stop - at));
      at = stop;
    }
    return true;
  }

  void format() {
    if (words_.size() < 2) fail("the format is missing");
    if (words_[1] == "ascii")
      header_.format = PlyFormat::ascii;
    else if (words_[1] == "binary_little_endian")
      header_.format = PlyFormat::littleEndian;
    else if (words_[1] == "binary_big_endian")
      header_.format = PlyFormat::bigEndian;
    else
      fail("unknown format " + inQuotes(words_[1]));
    hasFormat_ = true;
  }

  void element() {
    if (words_.size() != 3) fail("an element has a name and a count");
    PlyElement element;
    element.name = std::string(words_[1]);
    for (const char c : words_[2]) {
      const std::uint64_t digit = static_cast<std::uint64_t>(c - '0');
      if (c < '0' || c > '9' || element.count > (UINT64_MAX - digit) / 10)
        fail(inQuotes(words_[2]) + " is not a number of elements");
      element.count = element.count * 10 + digit;
    }
    header_.elements.push_back(std::move(element));
  }

  void property() {
    if (header_.elements.empty()) fail("a property stands before the first element");
    PlyProperty property;
    property.list = words_.size() > 1 && words_[1] == "list";
    if (words_.size() != (property.list ? 5u : 3u)) fail("a property has a type and a name");
    property.name = std::string(words_.back());
    if (!findType(words_[words_.size() - 2], property.type))
      fail("unknown type " + inQuotes(words_[words_.size() - 2]));
    if (property.list && (!findType(words_[2], property.countType) || isFloat(property.countType)))
      fail("unknown count type " + inQuotes(words_[2]));
    header_.elements.back().properties.push_back(std::move(property));
  }

  PlyHeader finish() {
    if (!hasFormat_) fail("the header has no format line");
    header_.bodyOffset = position_;
    return std::move(header_);
  }

  const FileBytes& file_;
  PlyHeader header_;
  std::vector<std::string_view> words_;
  std::size_t position_ = 0, line_ = 0, ending_ = 0;
  bool hasFormat_ = false;
};

}  // namespace

std::size_t plySize(PlyType type) {
  switch (type) {
    case PlyType::int8:
    case PlyType::uint8:
      return 1;
    case PlyType::int16:
    case PlyType::uint16:
      return 2;
    case PlyType::float64:
      return 8;
    default:
      return 4;
  }
}

PlyHeader readPlyHeader(const FileBytes& file) { return HeaderReader(file).read(); }

}  // namespace innermap
