// A whole file in memory, or parts of one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace innermap {

struct FileBytes {
  std::string path;
  std::string bytes;
};

// A file that stays open, of which parts are read. May be used by several threads.
class OpenFile {
 public:
  // what: what kind of file it should be, for messages: "a mesh file". Throws FileError for what is
  // no regular file, is empty or cannot be opened.
  OpenFile(const std::string& path, const std::string& what);
  ~OpenFile();
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;

  const std::string& path() const { return path_; }
  std::uint64_t size() const { return size_; }  // bytes, when it was opened

  // Throws FileError when the file has not got these bytes (any more); Cancelled.
  void read(std::uint64_t from, char* bytes, std::size_t count) const;

 private:
  std::string path_;
  int number_ = -1;
  std::uint64_t size_ = 0;
};

// what: as OpenFile's. Throws as that does; MemoryError when it is larger than the machine's
// memory; Cancelled.
FileBytes readFileBytes(const std::string& path, const std::string& what);

// Throws FileError when one more vertex, corner or the like would exceed what an int counts.
void requireCountable(const std::string& path, std::size_t count);

// ".obj" of "a/b.obj"; empty when there is none.
std::string extensionOf(const std::string& path);

}  // namespace innermap
