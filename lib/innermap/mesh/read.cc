#include "innermap/mesh/read.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "innermap/core/error.h"
#include "innermap/core/memory.h"
#include "innermap/mesh/detail/polygon_mesh.h"

namespace innermap {
namespace {

using Reader = PolygonMesh (*)(const FileBytes&, Progress*);

Reader readerOf(const std::string& path) {
  const std::size_t dot = path.find_last_of('.');
  const std::size_t slash = path.find_last_of('/');
  const bool has = dot != path.npos && (slash == path.npos || dot > slash);
  const std::string extension = has ? path.substr(dot) : "";
  if (equalsIgnoringCase(extension, ".obj")) return readObj;
  if (equalsIgnoringCase(extension, ".ply")) return readPly;
  if (equalsIgnoringCase(extension, ".off")) return readOff;
  if (equalsIgnoringCase(extension, ".stl")) return readStl;
  throw FileError(path, (has ? "unknown extension " + inQuotes(extension) : "has no extension") +
                            "; meshes are read from .obj, .ply, .off and .stl files");
}

struct Descriptor {
  int number;
  ~Descriptor() { close(number); }
};

std::string readBytes(const std::string& path, Progress* progress) {
  // Without O_NONBLOCK, opening a pipe that nobody writes to would wait for ever.
  const int number = open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (number < 0)
    throw FileError(path, std::string("cannot be opened (") + std::strerror(errno) +
                              "); check the name and its permissions");
  const Descriptor file{number};
  struct stat status {};
  if (fstat(number, &status) != 0)
    throw FileError(path, std::string("cannot be read (") + std::strerror(errno) + ")");
  if (S_ISDIR(status.st_mode)) throw FileError(path, "is a folder; give a mesh file");
  if (!S_ISREG(status.st_mode)) throw FileError(path, "is not a regular file; give a mesh file");
  if (status.st_size <= 0) throw FileError(path, "is empty; export the mesh again");
  const std::size_t size = static_cast<std::size_t>(status.st_size);
  requireMemory("reading " + path, size, availableMemory(), "use a coarser mesh");
  std::string bytes(size, '\0');
  constexpr std::size_t kChunk = std::size_t(16) << 20;
  for (std::size_t done = 0; done < size;) {
    throwIfCancelled(progress);
    const ssize_t got = read(number, &bytes[done], std::min(kChunk, size - done));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0)
      throw FileError(path, std::string("cannot be read (") + std::strerror(errno) + ")");
    if (got == 0) throw FileError(path, "became shorter while it was read; try again");
    done += static_cast<std::size_t>(got);
  }
  return bytes;
}

PolygonMesh readPolygons(const std::string& path, Progress* progress) {
  const Reader reader = readerOf(path);
  FileBytes file;
  file.path = path;
  file.bytes = readBytes(path, progress);
  return reader(file, progress);
}

}  // namespace

Mesh readMesh(const std::string& path, const ReadSettings& settings) {
  return toMesh(readPolygons(path, settings.progress), path, settings.progress);
}

Mesh readMeshLike(const std::string& path, const Mesh& reference, const ReadSettings& settings) {
  return toMeshLike(readPolygons(path, settings.progress), path, reference, settings.progress);
}

}  // namespace innermap
