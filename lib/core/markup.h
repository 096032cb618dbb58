// Text within XML and HTML.
#pragma once

#include <string>

namespace innermap {

// Text as XML and HTML take it: their signs escaped, bytes that are no UTF-8 and control characters
// replaced.
std::string markupText(const std::string& text);

}  // namespace innermap
