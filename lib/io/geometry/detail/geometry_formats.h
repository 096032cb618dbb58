// The formats behind io/geometry_file.h, and what they share.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "core/file_bytes.h"
#include "core/output_buffer.h"
#include "innermap/io/geometry_file.h"

namespace innermap {

std::unique_ptr<GeometryFile> readObjGeometry(FileBytes file);
std::unique_ptr<GeometryFile> readPlyGeometry(FileBytes file, const ReadGeometrySettings& settings);
std::unique_ptr<GeometryFile> readOffGeometry(FileBytes file);
std::unique_ptr<GeometryFile> readStlGeometry(FileBytes file);
std::unique_ptr<GeometryFile> readCellGeometry(const std::string& path,
                                               const ReadGeometrySettings& settings);

// Copies a file but for what is put in place of some of its bytes.
class FileCopy {
 public:
  FileCopy(const FileBytes& file, OutputBuffer& out) : bytes_(file.bytes), out_(out) {}

  // Copies what comes before that byte.
  void to(std::size_t byte) {
    out_.raw(bytes_.substr(next_, byte - next_));
    next_ = byte;
  }
  void skipTo(std::size_t byte) { next_ = byte; }

 private:
  std::string_view bytes_;
  OutputBuffer& out_;
  std::size_t next_ = 0;
};

// Whether all of the file's things are still there as they were.
inline bool unchanged(const CarriedGeometry& carried) {
  return carried.added == 0 && carried.points.cut == 0;
}

}  // namespace innermap
