// The triangles of an STL file, text or binary, one after the other, with where they stand in it.
#pragma once

#include "core/text_scanner.h"

namespace innermap {

class StlScanner {
 public:
  // `file` must outlive the scanner. normals: whether these are read; otherwise they may be
  // anything. Throws FileError for what is no STL.
  StlScanner(const FileBytes& file, bool normals);

  static constexpr std::size_t kHeader = 84, kRecord = 50;  // bytes of a binary file
  bool binary() const { return binary_; }
  std::size_t triangles() const { return records_; }  // of a binary file

  // Goes to the next triangle; false at the end. Throws FileError for corners that are not finite
  // and text that is wrong or cut short.
  bool next();

  // Of the triangle: its normal and its corners, the bytes of the three numbers of each, and all of
  // its bytes (in text, lines).
  struct Span {
    std::size_t begin = 0, end = 0;
  };
  Vec3 rows[4];
  Span span(std::size_t row) const {
    return binary_ ? Span{facet.begin + 12 * row, facet.begin + 12 * row + 12} : spans_[row];
  }
  Span facet;

 private:
  bool nextRecord();
  bool nextFacet();
  void readRow(std::size_t row);

  const FileBytes& file_;
  TextScanner scanner_;
  Span spans_[4];  // in text
  bool normals_, binary_, ended_ = false;
  std::size_t records_ = 0, read_ = 0;  // lines or records
};

}  // namespace innermap
