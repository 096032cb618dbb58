#include "mesh/stl_scanner.h"

#include <fmt/format.h>

#include <cstring>

#include "innermap/core/error.h"
#include "innermap/core/run.h"

static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "numbers are copied as they are");

namespace innermap {

StlScanner::StlScanner(const FileBytes& file, bool normals)
    : file_(file), scanner_(file, {}), normals_(normals) {
  const std::size_t size = file.bytes.size();
  std::uint32_t promised = 0;
  if (size >= kHeader) std::memcpy(&promised, file.bytes.data() + 80, 4);
  // Many binary files begin with "solid" too, so the size decides.
  const std::size_t needed = kHeader + promised * kRecord;
  binary_ = size == needed;
  if (binary_) records_ = promised;
  const std::size_t first = file.bytes.find_first_not_of(" \t\r\n");
  if (binary_ ||
      (first != file.bytes.npos && equalsIgnoringCase(file.bytes.substr(first, 5), "solid")))
    return;
  if (size < kHeader)
    throw FileError(file.path, "is neither text nor binary STL; give an STL file");
  throw FileError(
      file.path, fmt::format("a binary STL file of {} triangles, as its header says, has {} bytes, "
                             "this one {}; it is cut short or not STL; export it again",
                             promised, needed, size));
}

bool StlScanner::next() { return binary_ ? nextRecord() : nextFacet(); }

bool StlScanner::nextRecord() {
  if (read_ == records_) return false;
  if (read_ % 65536 == 0) throwIfCancelled();
  facet = {kHeader + kRecord * read_, kHeader + kRecord * (read_ + 1)};
  for (std::size_t k = normals_ ? 0 : 1; k < 4; ++k) {
    float numbers[3];
    std::memcpy(numbers, file_.bytes.data() + facet.begin + 12 * k, sizeof numbers);
    rows[k] = {numbers[0], numbers[1], numbers[2]};
    if (k > 0 && !isFinite(rows[k]))
      throw FileError(file_.path, fmt::format("triangle {} has a corner that is not finite; "
                                              "export the mesh again",
                                              read_));
  }
  ++read_;
  return true;
}

void StlScanner::readRow(std::size_t row) {
  spans_[row].begin = scanner_.position();
  rows[row] = scanner_.nextVec3("three numbers");
  spans_[row].end = scanner_.position();
}

bool StlScanner::nextFacet() {
  std::string_view word;
  const auto is = [&](const char* keyword) { return equalsIgnoringCase(word, keyword); };
  std::size_t corners = 0;
  bool within = false;
  while (scanner_.nextFilledLine(word)) {
    if (++read_ % 65536 == 0) throwIfCancelled();
    if (is("vertex")) {
      if (!within || corners == 3)
        scanner_.fail("a corner stands outside a facet, or is its fourth");
      readRow(++corners);
    } else if (is("facet")) {
      if (within) scanner_.fail("a facet begins within another");
      within = true;
      facet.begin = scanner_.lineBegin();
      if (!normals_) continue;
      scanner_.token(word);
      readRow(0);
    } else if (is("endfacet")) {
      if (corners != 3) scanner_.fail(fmt::format("a facet has three corners, here {}", corners));
      facet.end = scanner_.endLine();
      return true;
    } else if (is("solid") || is("endsolid")) {
      ended_ = word.size() > 5;
    } else if (!is("outer") && !is("endloop") && !is("color")) {
      scanner_.fail(inQuotes(word) + " is no keyword of STL; give an STL file");
    }
  }
  if (!ended_ || within)
    scanner_.fail("the file ends without endsolid, it is cut short; export it again");
  return false;
}

}  // namespace innermap
