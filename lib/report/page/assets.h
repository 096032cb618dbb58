// What report.html is made of: the files of assets/ and the drawing library, built in.
#pragma once

#include <string>
#include <string_view>

namespace innermap {

// Empty when there is none of that name.
std::string_view pageAsset(const std::string& name);

}  // namespace innermap
