#include "innermap/core/version.h"

namespace innermap {

const char* versionText() { return "0.1.0"; }

}  // namespace innermap
