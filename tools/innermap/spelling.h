// British and American spellings of what the command line takes.
#pragma once

#include <string>
#include <vector>

namespace innermap::tool {

// `name` first, then its other spellings: "--colour", "--color".
std::vector<std::string> spellings(const std::string& name);

}  // namespace innermap::tool
