// Texts of options of export and import.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "innermap/core/vec3.h"

namespace innermap::tool {

// "8x8": columns and rows, each from 1 to 65536. Throws UsageError naming `option`.
std::pair<int, int> parseTiles(const std::string& option, const std::string& text);

// "X,Y,Z". Throws UsageError naming `option`.
Vec3 parsePoint(const std::string& option, const std::string& text);

}  // namespace innermap::tool
