#include "lists.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "command.h"

namespace innermap::tool {
namespace {

// Whether all of the text is one number.
template <class Number>
bool parse(const std::string& text, Number& value) {
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  return error == std::errc() && stop == end && std::isfinite(static_cast<double>(value));
}

}  // namespace

std::vector<std::string> commaList(const std::string& list) {
  std::vector<std::string> parts;
  for (std::size_t from = 0; from < list.size();) {
    const std::size_t comma = std::min(list.find(',', from), list.size());
    if (comma > from) parts.push_back(list.substr(from, comma - from));
    from = comma + 1;
  }
  return parts;
}

std::vector<double> parseNumbers(const std::string& option, const std::string& text,
                                 std::size_t count, const std::string& what) {
  std::vector<double> numbers;
  for (const std::string& part : commaList(text))
    if (!parse(part.substr(std::min(part.find_first_not_of(' '), part.size())),
               numbers.emplace_back()))
      numbers.assign(count + 1, 0);
  if (numbers.size() != count) throw UsageError(option + ": '" + text + "' is not " + what);
  return numbers;
}

std::pair<int, int> parseTiles(const std::string& option, const std::string& text) {
  const std::size_t x = std::min(text.find_first_of("xX"), text.size());
  int columns = 0, rows = 0;
  const bool good = x < text.size() && parse(text.substr(0, x), columns) &&
                    parse(text.substr(x + 1), rows) && std::min(columns, rows) >= 1 &&
                    std::max(columns, rows) <= 65536;
  if (!good) throw UsageError(option + ": '" + text + "' is not columns x rows, such as 8x8");
  return {columns, rows};
}

}  // namespace innermap::tool
