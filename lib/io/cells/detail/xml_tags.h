// As much of XML as VTK's files need: tags with attributes, one after the other.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/file_bytes.h"

namespace innermap {

struct XmlTag {
  std::string_view name;
  bool closing = false;                                              // </name>
  bool complete = false;                                             // <name/>
  std::vector<std::pair<std::string_view, std::string>> attributes;  // entities resolved
  std::size_t begin = 0, end = 0;                                    // bytes of '<' and after '>'

  // Empty when there is none.
  std::string attribute(std::string_view name) const;
};

class XmlTags {
 public:
  explicit XmlTags(const FileBytes& file) : file_(file) {}  // which must outlive it

  // The next tag; comments, declarations and text are passed over. False at the end of the file.
  // Throws FileError for a tag that is none.
  bool next(XmlTag& tag);

  std::size_t position() const { return position_; }
  // Goes to a byte.
  void skipTo(std::size_t position) { position_ = position; }

 private:
  void readAttributes(XmlTag& tag);
  char peek() const { return position_ < file_.bytes.size() ? file_.bytes[position_] : '\0'; }
  void skipSpace();
  std::string_view word();

  const FileBytes& file_;
  std::size_t position_ = 0;
};

}  // namespace innermap
