// Values of a PLY file's body, one after the other, with where they stand in the file.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "core/output_buffer.h"
#include "core/ply_header.h"

namespace innermap {

class PlyBody {
 public:
  PlyBody(const FileBytes& file, const PlyHeader& header)
      : file_(file),
        ascii_(header.format == PlyFormat::ascii),
        bigEndian_(header.format == PlyFormat::bigEndian),
        position_(header.bodyOffset),
        scanner_(file, {}, header.bodyOffset) {}

  bool ascii() const { return ascii_; }
  std::size_t position() const { return ascii_ ? scanner_.position() : position_; }
  void seek(std::size_t position);

  // Rows of the element, which comes next; none where it has no properties. Throws FileError unless
  // so many can be in what is left.
  std::uint64_t rows(const PlyElement& element) const;

  // The bytes of the next value. Throws FileError when the file ends.
  std::string_view next(PlyType type);
  // Throws FileError for text that is no finite number.
  double nextValue(PlyType type);
  // Items of the next list; of what is no list, one. Throws FileError when they cannot be there.
  std::uint64_t items(const PlyProperty& property);
  void skip(const PlyProperty& property);
  void skipRow(const PlyElement& element);

  // A value as the file writes it: the bytes, or digits with a space before.
  void put(OutputBuffer& out, PlyType type, double value) const;
  void put(OutputBuffer& out, std::string_view bytes) const {
    if (ascii_) out.raw(" ");
    out.raw(bytes);
  }

  [[noreturn]] void fail(const std::string& what) const;

 private:
  double nextNumber(PlyType type);
  // Numbers of a text take two bytes, but the last may lack its white space.
  std::uint64_t leastBytes(PlyType type) const { return ascii_ ? 2 : plySize(type); }
  std::uint64_t remaining() const { return file_.bytes.size() - position() + (ascii_ ? 1 : 0); }

  const FileBytes& file_;
  bool ascii_, bigEndian_;
  std::size_t position_;  // in binary files
  TextScanner scanner_;   // of text
};

enum class PlyRole { other, vertices, faces, strips, edges };
PlyRole plyRole(const PlyElement& element);

// What a property of faces, strips and edges is.
enum class PlyPart { other, corners, uvs, end };
PlyPart plyPart(PlyRole role, const PlyProperty& property);

// Rows of such an element.
class PlyFaces {
 public:
  explicit PlyFaces(const PlyElement& element);

  void read(PlyBody& body);

  // Of the row that was read: vertices, in strips also -1, else from 0, of unknown number; two
  // texture coordinates for each, or some other number of them.
  std::vector<int> corners;
  std::vector<double> uvs;

 private:
  int corner(PlyBody& body, PlyType type) const;
  static double uv(PlyBody& body, PlyType type);

  const PlyElement& element_;
  PlyRole role_;
  std::vector<PlyPart> parts_;
};

}  // namespace innermap
