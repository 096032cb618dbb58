// libFuzzer's driver for the readers: innermap_fuzz --reader=NAME [libFuzzer's options] [corpora].
// --list prints the readers and the extensions of their files; --say what is wrong with each input.
#include <OpenImageIO/imageio.h>
#include <fcntl.h>
#include <openvdb/openvdb.h>
#include <tbb/global_control.h>
#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>

#include "innermap/core/error.h"
#include "readers.h"

namespace {

const innermap::fuzz::Reader* chosen = nullptr;
bool saying = false;

// Readers take paths and look at their endings.
std::string inputPath() {
  const char* folder = std::getenv("TMPDIR");
  return std::string(folder ? folder : "/dev/shm") + "/fuzz-" + std::to_string(getpid()) + "." +
         chosen->extension;
}

const std::string& writtenInput(const std::uint8_t* data, std::size_t size) {
  static const std::string path = inputPath();
  static const int file = open(path.c_str(), O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
  if (file < 0 || ftruncate(file, 0) != 0 ||
      pwrite(file, data, size, 0) != static_cast<ssize_t>(size)) {
    std::perror(path.c_str());
    std::_Exit(2);
  }
  return path;
}

}  // namespace

// libFuzzer's names. NOLINTBEGIN(readability-identifier-naming)
extern "C" int LLVMFuzzerInitialize(int* count, char*** values) {
  bool listing = false;
  for (int i = 1; i < *count; ++i) {
    listing = listing || !std::strcmp((*values)[i], "--list");
    saying = saying || !std::strcmp((*values)[i], "--say");
    for (const innermap::fuzz::Reader& reader : innermap::fuzz::readers()) {
      if (listing) std::printf("%s %s\n", reader.name, reader.extension);
      if ((*values)[i] == std::string("--reader=") + reader.name) chosen = &reader;
    }
  }
  if (!chosen) std::exit(listing ? 0 : 2);
  // One thread: faster for files of a few kB, and the same each time.
  static const tbb::global_control threads(tbb::global_control::max_allowed_parallelism, 1);
  OIIO::attribute("threads", 1);
  OIIO::attribute("exr_threads", -1);
  openvdb::initialize();
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    chosen->read(writtenInput(data, size));
  } catch (const innermap::Error& error) {
    if (saying) std::fprintf(stderr, "%s\n", error.what());
  }
  return 0;
}
// NOLINTEND(readability-identifier-naming)
