// A whole file in memory.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace innermap {

struct FileBytes {
  std::string path;
  std::string bytes;
};

// what: what kind of file it should be, for messages: "a mesh file". Throws FileError for what is
// no regular file, is empty or cannot be read; MemoryError when it is larger than the machine's
// memory; Cancelled.
FileBytes readFileBytes(const std::string& path, const std::string& what);

// Throws FileError when one more vertex, corner or the like would exceed what an int counts.
void requireCountable(const std::string& path, std::size_t count);

// ".obj" of "a/b.obj"; empty when there is none.
std::string extensionOf(const std::string& path);

}  // namespace innermap
