// The version of this library.
#pragma once

namespace innermap {

const char* versionText();  // "0.1.0"

}  // namespace innermap
