#include "report/table.h"

#include <fmt/format.h>

#include <cmath>
#include <ostream>

#include "core/file.h"
#include "innermap/core/error.h"

namespace innermap {
namespace {

constexpr double kWhole = 1e15;  // whole numbers up to it have all their digits

std::string textOf(double value) {
  if (!std::isfinite(value)) return "";
  const bool whole = std::abs(value) < kWhole && value == std::floor(value);
  return whole ? fmt::format("{:.0f}", value) : fmt::format("{:.9g}", value);
}

std::string textOf(const std::string& text) {
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? std::string("\"\"") : std::string(1, c);
  return out + "\"";
}

struct FieldsOf {
  std::vector<std::string> operator()(const std::vector<double>& list) const { return of(list); }
  std::vector<std::string> operator()(const std::vector<std::string>& list) const {
    return of(list);
  }
  template <class Value>
  std::vector<std::string> operator()(const Value&) const {
    throw Error("a table's columns are lists");
  }

 private:
  template <class List>
  static std::vector<std::string> of(const List& list) {
    std::vector<std::string> out;
    for (const auto& value : list) out.push_back(textOf(value));
    return out;
  }
};

}  // namespace

void writeTable(const std::string& path, const Figures& columns) {
  std::vector<std::vector<std::string>> fields;
  for (const Figure& f : columns) fields.push_back(std::visit(FieldsOf(), f.value));
  for (const auto& column : fields)
    if (column.size() != fields.front().size()) throw Error("a table's columns differ in length");
  writeWholeFile(path, [&](std::ostream& file) {
    for (std::size_t c = 0; c < columns.size(); ++c) file << (c ? "," : "") << columns[c].key;
    file << "\n";
    for (std::size_t row = 0; !fields.empty() && row < fields.front().size(); ++row) {
      for (std::size_t c = 0; c < fields.size(); ++c) file << (c ? "," : "") << fields[c][row];
      file << "\n";
    }
  });
}

}  // namespace innermap
