#include "mesh/off_scanner.h"

#include <fmt/format.h>

#include "innermap/core/run.h"

namespace innermap {

OffScanner::OffScanner(const FileBytes& file) : file_(file), scanner_(file, {true, false}) {
  std::string_view word;
  if (!scanner_.nextFilledLine(word)) scanner_.fail("the file has no content; give an OFF file");
  readKeyword(word);
  // The counts may follow in the same line, even without a space.
  if (word.empty() && !scanner_.token(word) && !scanner_.nextFilledLine(word)) cutShort();
  if (word == "BINARY")
    scanner_.fail("binary OFF is not read; export the mesh as text OFF or binary PLY");
  countsBegin = static_cast<std::size_t>(word.data() - file.bytes.data());
  vertices = count(word, normals ? 6 : 3);
  if (!scanner_.anyToken(word)) cutShort();
  faces = count(word, 1);
  if (scanner_.token(word)) edges = scanner_.integer(word);
  countsEnd = static_cast<std::size_t>(word.data() + word.size() - file.bytes.data());
}

void OffScanner::readKeyword(std::string_view& word) {
  const std::size_t off = word.substr(0, 8).find("OFF");
  if (off == word.npos) notOff();
  std::string_view prefix = word.substr(0, off);
  const auto strip = [&](std::string_view letters) {
    const bool has = prefix.substr(0, letters.size()) == letters;
    if (has) prefix.remove_prefix(letters.size());
    return has;
  };
  uvs = strip("ST");
  colours = strip("C");
  normals = strip("N");
  if (prefix == "4" || prefix == "n" || prefix == "4n")
    scanner_.fail("the file has four or n dimensions; export the mesh in three");
  if (!prefix.empty()) notOff();
  word.remove_prefix(off + 3);
}

void OffScanner::notOff() const {
  scanner_.fail("an OFF file begins with OFF, COFF, NOFF or STOFF; give an OFF file");
}

void OffScanner::cutShort() const {
  scanner_.fail("the file is cut short or promises too much; export it again");
}

// Each promised item takes at least `numbers` numbers of two bytes.
std::int64_t OffScanner::count(std::string_view word, std::int64_t numbers) const {
  const std::int64_t value = scanner_.integer(word);
  if (value < 0) scanner_.fail("a count is negative; export the mesh again");
  if (value > static_cast<std::int64_t>(scanner_.remainingBytes() + 1) / (2 * numbers))
    scanner_.fail(
        fmt::format("{} items do not fit in the {} bytes left; the file is cut short "
                    "or promises too much; export it again",
                    value, scanner_.remainingBytes()));
  requireCountable(file_.path, static_cast<std::size_t>(value));
  return value;
}

std::string_view OffScanner::nextLine() {
  if (lines_++ % 65536 == 0) throwIfCancelled();
  std::string_view word;
  if (!scanner_.nextFilledLine(word)) cutShort();
  return word;
}

Vec3 OffScanner::nextVertex() {
  const double x = scanner_.number(nextLine());
  const double y = scanner_.nextNumber("y");
  return {x, y, scanner_.nextNumber("z")};
}

const std::vector<int>& OffScanner::nextFace() {
  const std::int64_t corners = scanner_.integer(nextLine());
  if (corners < 0 || corners > static_cast<std::int64_t>(scanner_.remainingBytes() + 1) / 2)
    cutShort();
  corners_.clear();
  for (std::int64_t k = 0; k < corners; ++k) {
    std::string_view word;
    if (!scanner_.token(word)) scanner_.fail("the line ends before its corners");
    const std::int64_t v = scanner_.integer(word);
    if (v < 0 || v >= vertices)
      scanner_.fail(
          fmt::format("vertex {} is out of range, the file has {} (counted from 0)", v, vertices));
    corners_.push_back(static_cast<int>(v));
  }
  return corners_;
}

}  // namespace innermap
