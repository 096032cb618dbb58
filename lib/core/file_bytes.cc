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
namespace {

struct Descriptor {
  int number;
  ~Descriptor() { close(number); }
};

}  // namespace

FileBytes readFileBytes(const std::string& path, const std::string& what) {
  // Without O_NONBLOCK, opening a pipe that nobody writes to would wait for ever.
  const int number = open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (number < 0)
    throw FileError(path, std::string("cannot be opened (") + std::strerror(errno) +
                              "); check the name and its permissions");
  const Descriptor file{number};
  struct stat status {};
  if (fstat(number, &status) != 0)
    throw FileError(path, std::string("cannot be read (") + std::strerror(errno) + ")");
  if (S_ISDIR(status.st_mode)) throw FileError(path, "is a folder; give " + what);
  if (!S_ISREG(status.st_mode)) throw FileError(path, "is not a regular file; give " + what);
  if (status.st_size <= 0) throw FileError(path, "is empty; export it again");
  const std::size_t size = static_cast<std::size_t>(status.st_size);
  requireMemory("reading " + path, size, availableMemory(), "use a coarser one");
  std::string bytes(size, '\0');
  constexpr std::size_t kChunk = std::size_t(16) << 20;
  for (std::size_t done = 0; done < size;) {
    throwIfCancelled();
    const ssize_t got = read(number, &bytes[done], std::min(kChunk, size - done));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0)
      throw FileError(path, std::string("cannot be read (") + std::strerror(errno) + ")");
    if (got == 0) throw FileError(path, "became shorter while it was read; try again");
    done += static_cast<std::size_t>(got);
  }
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
