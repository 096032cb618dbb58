#include "version.h"

#include <OpenEXR/OpenEXRConfig.h>
#include <fmt/format.h>
#include <openvdb/version.h>
#include <zlib.h>

#include <sstream>

#ifdef INNERMAP_BUILD_PICTURES
#include <OpenImageIO/oiioversion.h>
#define INNERMAP_PICTURES "OpenImageIO " OIIO_VERSION_STRING
#else
#define INNERMAP_PICTURES "no OpenImageIO"
#endif

#include "commit.h"
#include "innermap/core/version.h"

// Not by a header: cblas.h may be another library's.
// NOLINTBEGIN(readability-identifier-naming)
extern "C" char* openblas_get_config(void);
extern "C" const char* TBB_runtime_version();
// NOLINTEND(readability-identifier-naming)

namespace innermap::tool {
namespace {

// Of "OpenBLAS 0.3.21 NO_AFFINITY ..." the second word.
std::string openblasVersion() {
  std::istringstream words(openblas_get_config());
  std::string name, version;
  words >> name >> version;
  return version;
}

}  // namespace

std::string versionAndLibraries() {
  const std::string commit = *INNERMAP_COMMIT ? " (commit " INNERMAP_COMMIT ")" : "";
  return fmt::format(
      "innermap {}{}\n"
      "OpenVDB {}, TBB {}, OpenEXR {}, " INNERMAP_PICTURES
      "\n"
      "OpenBLAS {}, zlib {}, fmt {}.{}.{}, compiler {}\n",
      versionText(), commit, OPENVDB_LIBRARY_VERSION_STRING, TBB_runtime_version(),
      OPENEXR_VERSION_STRING, openblasVersion(), zlibVersion(), FMT_VERSION / 10000,
      FMT_VERSION / 100 % 100, FMT_VERSION % 100, __VERSION__);
}

}  // namespace innermap::tool
