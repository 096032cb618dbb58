// The vertices and faces of an OFF file as text, one after the other, a line each.
#pragma once

#include <vector>

#include "core/text_scanner.h"

namespace innermap {

class OffScanner {
 public:
  // Reads the header. `file` must outlive the scanner. Throws FileError, as all of its functions
  // do.
  explicit OffScanner(const FileBytes& file);

  std::int64_t vertices = 0, faces = 0, edges = 0;
  bool normals = false, colours = false, uvs = false;  // that vertices have, in this order
  std::size_t countsBegin = 0, countsEnd = 0;          // bytes of the three numbers above

  // The place of the next vertex; what else its line has comes next in text().
  Vec3 nextVertex();
  // The corners of the next face, in range.
  const std::vector<int>& nextFace();

  TextScanner& text() { return scanner_; }

 private:
  void readKeyword(std::string_view& word);
  std::int64_t count(std::string_view word, std::int64_t numbers) const;
  std::string_view nextLine();
  [[noreturn]] void notOff() const;
  [[noreturn]] void cutShort() const;

  const FileBytes& file_;
  TextScanner scanner_;
  std::vector<int> corners_;
  std::size_t lines_ = 0;
};

}  // namespace innermap
