// Values of a PLY file's body, one after the other, with where they stand in the file.
#pragma once

#include <cstdint>
#include <string_view>

#include "core/ply_header.h"
#include "io/geometry/detail/geometry_formats.h"

namespace innermap {

class PlyBody {
 public:
  PlyBody(const FileBytes& file, const PlyHeader& header)
      : file_(file),
        ascii_(header.format == PlyFormat::ascii),
        bigEndian_(header.format == PlyFormat::bigEndian),
        position_(header.bodyOffset) {}

  bool ascii() const { return ascii_; }
  std::size_t position() const { return position_; }
  void seek(std::size_t position) { position_ = position; }

  // The bytes of the next value. Throws FileError when the file ends.
  std::string_view next(PlyType type);
  double value(std::string_view bytes, PlyType type) const;
  // Items of the next list. Throws FileError when they cannot be there.
  std::uint64_t listSize(const PlyProperty& property);
  void skipRow(const PlyElement& element);
  // Throws FileError unless so many rows can be in what is left.
  void requireRoom(const PlyElement& element) const;

  // A value as the file writes it: the bytes, or digits with a space before.
  void put(OutputBuffer& out, PlyType type, double value) const;

  [[noreturn]] void fail(const std::string& what) const;

 private:
  const FileBytes& file_;
  bool ascii_, bigEndian_;
  std::size_t position_;
};

}  // namespace innermap
