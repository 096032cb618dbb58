#include "core/file_bytes.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <limits>
#include <utility>

#include "innermap/core/error.h"
#include "innermap/core/memory.h"
#include "innermap/core/run.h"

namespace innermap {
OpenFile::OpenFile(const std::string& path, const std::string& what) : path_(path) {
  // Without O_NONBLOCK, opening a pipe that nobody writes to would wait for ever.
  number_ = open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (number_ < 0)
    throw FileError(path, std::string("cannot be opened (") + std::strerror(errno) +
                              "); check the name and its permissions");
  const auto refuse = [&](const std::string& why) {
    close(number_);
    throw FileError(path, why);
  };
  struct stat status {};
  if (fstat(number_, &status) != 0)
    refuse(std::string("cannot be read (") + std::strerror(errno) + ")");
  if (S_ISDIR(status.st_mode)) refuse("is a folder; give " + what);
  if (!S_ISREG(status.st_mode)) refuse("is not a regular file; give " + what);
  if (status.st_size <= 0) refuse("is empty; export it again");
  size_ = static_cast<std::uint64_t>(status.st_size);
}

OpenFile::~OpenFile() { close(number_); }

void OpenFile::read(std::uint64_t from, char* bytes, std::size_t count) const {
  constexpr std::size_t kChunk = std::size_t(16) << 20;
  for (std::size_t done = 0; done < count;) {
    throwIfCancelled();
    const ssize_t got = pread(number_, bytes + done, std::min(kChunk, count - done),
                              static_cast<off_t>(from + done));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0)
      throw FileError(path_, std::string("cannot be read (") + std::strerror(errno) + ")");
    if (got == 0) throw FileError(path_, "became shorter while it was read; try again");
    done += static_cast<std::size_t>(got);
  }
}

FileBytes readFileBytes(const std::string& path, const std::string& what) {
  const OpenFile file(path, what);
  const std::size_t size = static_cast<std::size_t>(file.size());
  requireMemory("reading " + path, size, availableMemory(), "use a coarser one");
  std::string bytes(size, '\0');
  file.read(0, bytes.data(), size);
  return {path, std::move(bytes)};
}

void requireCountable(const std::string& path, std::size_t count) {
  if (count >= static_cast<std::size_t>(std::numeric_limits<int>::max()))
    throw FileError(path, "has more than 2147483646 vertices or corners; cut it into parts");
}

std::string extensionOf(const std::string& path) {
  const std::size_t dot = path.find_last_of('.');
  const std::size_t slash = path.find_last_of('/');
  const bool has = dot != path.npos && (slash == path.npos || dot > slash);
  return has ? path.substr(dot) : "";
}

}  // namespace innermap
