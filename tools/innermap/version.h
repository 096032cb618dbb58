// What --version prints.
#pragma once

#include <string>

namespace innermap::tool {

// "innermap 0.1.0 (commit 1234567890)" and the libraries that it was built with, a line each.
std::string versionAndLibraries();

}  // namespace innermap::tool
