// The lines of an OBJ file, one after the other, with where they stand in it.
#pragma once

#include <vector>

#include "core/text_scanner.h"

namespace innermap {

constexpr TextSyntax kObjSyntax{true, true};

enum class ObjLine { vertex, normal, texture, face, line, points, other };

// Counted from 0; -1 where there is none.
struct ObjCorner {
  int vertex = -1, texture = -1, normal = -1;
};

class ObjScanner {
 public:
  // `file` must outlive the scanner. normals: whether corners' normals are read; otherwise these
  // may have any number.
  ObjScanner(const FileBytes& file, bool normals) : normals_(normals), text_(file, kObjSyntax) {}

  // Goes to the next line that says something; false at the end of the file.
  bool next();

  ObjLine kind() const { return kind_; }
  std::string_view keyword() const { return keyword_; }
  TextScanner& text() { return text_; }  // behind the keyword
  double fraction() const;               // of the file

  // The corners of a face, a line or points, as many as these need. They may be of what comes
  // later. Throws FileError, as text() does.
  const std::vector<ObjCorner>& corners();
  // At the end of the file: throws FileError for corners of what the file has not.
  void requireInRange() const;

 private:
  // Of vertices, texture coordinates or normals.
  struct Channel {
    const char* name;
    std::int64_t count = 0, highest = 0;  // so far in the file and in corners
    std::size_t byte = 0;                 // of the highest
  };

  ObjCorner corner(std::string_view word);
  int index(std::string_view word, Channel& channel) const;

  bool normals_;
  TextScanner text_;
  std::string_view keyword_;
  ObjLine kind_ = ObjLine::other;
  Channel vertex_{"vertex"}, texture_{"texture coordinate"}, normal_{"normal"};
  std::vector<ObjCorner> corners_;
};

}  // namespace innermap
