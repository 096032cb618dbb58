// The formats behind io/geometry_file.h, and what they share.
#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <iterator>
#include <memory>
#include <ostream>
#include <string>
#include <string_view>
#include <utility>

#include "core/file_bytes.h"
#include "core/output_buffer.h"
#include "innermap/io/geometry_file.h"

namespace innermap {

std::unique_ptr<GeometryFile> readObjGeometry(FileBytes file, const ReadGeometrySettings& settings);
std::unique_ptr<GeometryFile> readPlyGeometry(FileBytes file, const ReadGeometrySettings& settings);
std::unique_ptr<GeometryFile> readOffGeometry(FileBytes file, const ReadGeometrySettings& settings);
std::unique_ptr<GeometryFile> readStlGeometry(FileBytes file, const ReadGeometrySettings& settings);
std::unique_ptr<GeometryFile> readCellGeometry(const std::string& path,
                                               const ReadGeometrySettings& settings);

// The words of one line of text, with where they stand. Continued lines ('\' at the end) count as
// one; a '#' ends it where comments are.
class LineWords {
 public:
  LineWords(const FileBytes& file, std::size_t begin, std::size_t end, bool comments)
      : bytes_(&file.bytes), position_(begin), end_(end), comments_(comments) {}

  bool next(std::string_view& word);
  std::size_t position() const { return position_; }  // behind the last word

 private:
  bool separates(std::size_t at) const;
  const std::string* bytes_;
  std::size_t position_, end_;
  bool comments_;
};

// The lines of a text, each with its end; lines that '\' continues as one, where asked for.
class TextLines {
 public:
  TextLines(const FileBytes& file, bool continued, std::size_t begin = 0);

  // [begin, end) of the next line, its line break included; false at the end of the file.
  bool next(std::size_t& begin, std::size_t& end);
  std::size_t line() const { return line_; }  // the number of the line that next() gave

 private:
  const std::string& bytes_;
  bool continued_;
  char separator_ = '\n';
  std::size_t position_, line_ = 0, nextLine_ = 1;
};

// "path: line 12: what".
[[noreturn]] void failAtLine(const FileBytes& file, std::size_t line, const std::string& what);

// Throw FileError with the line.
double numberOf(const FileBytes& file, std::size_t line, std::string_view word);
std::int64_t integerOf(const FileBytes& file, std::size_t line, std::string_view word);

// Throws FileError when there are more than an int counts.
void requireCountable(const FileBytes& file, std::size_t count, const char* what);

// Whether all of the file's things are still there as they were.
inline bool unchanged(const CarriedGeometry& carried) {
  return carried.added == 0 && carried.points.cut == 0;
}

}  // namespace innermap
