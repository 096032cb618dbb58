// Lists as options take them.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

namespace innermap::tool {

// The parts of "a,b,c"; empty ones do not count.
inline std::vector<std::string> commaList(const std::string& list) {
  std::vector<std::string> parts;
  for (std::size_t from = 0; from < list.size();) {
    const std::size_t comma = std::min(list.find(',', from), list.size());
    if (comma > from) parts.push_back(list.substr(from, comma - from));
    from = comma + 1;
  }
  return parts;
}

}  // namespace innermap::tool
