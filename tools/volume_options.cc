#include "volume_options.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "command.h"
#include "lists.h"

namespace innermap::tool {
namespace {

// A whole number with nothing after it; 0 for what is none.
int count(const std::string& text) {
  if (text.empty() || text.size() > 5 || text.find_first_not_of("0123456789") != std::string::npos)
    return 0;
  const int n = std::atoi(text.c_str());
  return n <= 65536 ? n : 0;
}

}  // namespace

std::pair<int, int> parseTiles(const std::string& option, const std::string& text) {
  const std::size_t x = text.find_first_of("xX");
  const int columns = x == std::string::npos ? 0 : count(text.substr(0, x));
  const int rows = x == std::string::npos ? 0 : count(text.substr(x + 1));
  if (columns < 1 || rows < 1)
    throw UsageError(option + ": '" + text + "' is not columns x rows, such as 8x8");
  return {columns, rows};
}

Vec3 parsePoint(const std::string& option, const std::string& text) {
  const std::vector<std::string> parts = commaList(text);
  Vec3 point;
  bool good = parts.size() == 3;
  for (int a = 0; good && a < 3; ++a) {
    char* end = nullptr;
    const std::string& part = parts[static_cast<std::size_t>(a)];
    point[a] = std::strtod(part.c_str(), &end);
    good = *end == 0 && std::isfinite(point[a]);
  }
  if (!good) throw UsageError(option + ": '" + text + "' is not three numbers X,Y,Z");
  return point;
}

}  // namespace innermap::tool
