#include "innermap/core/version.h"

namespace innermap {

const char* versionText() { return INNERMAP_VERSION; }

}  // namespace innermap
