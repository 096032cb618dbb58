// Lists as options take them.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace innermap::tool {

// The parts of "a,b,c"; empty ones do not count.
std::vector<std::string> commaList(const std::string& list);

// "X,Y,Z": so many finite numbers. Throws UsageError: `option`: 'text' is not `what`.
std::vector<double> parseNumbers(const std::string& option, const std::string& text,
                                 std::size_t count, const std::string& what);

// "8x8": columns and rows, each from 1 to 65536. Throws UsageError naming `option`.
std::pair<int, int> parseTiles(const std::string& option, const std::string& text);

}  // namespace innermap::tool
