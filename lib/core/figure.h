// Figures of results: each is described once, by a function figures(result) beside the result's
// struct. Reports, their schema, the page, comments of maps and Python's dicts derive from these.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "innermap/core/vec3.h"

namespace innermap {

// What a number is measured in.
enum class FigureUnit {
  none,
  share,      // 0 to 1
  diagonals,  // of the bounding box: of the target's, where there is one
  length,     // world units
  volume,     // world units cubed
  degrees,
  seconds,
  bytes
};

// As sentences have it: "fraction of the diagonal"; empty for none.
std::string textOf(FigureUnit unit);

// std::uint64_t: a count.
using FigureValue = std::variant<bool, std::uint64_t, std::int64_t, double, std::string,
                                 std::vector<double>, std::vector<std::string>>;

struct Figure {
  std::string key;      // [a-z0-9_], as in report.json; a dot leads into a section: "stretch.p99"
  std::string name;     // for people: "99% within"
  std::string meaning;  // half a sentence that goes on where the name ends, or empty
  FigureUnit unit = FigureUnit::none;
  FigureValue value;  // has its type even where it is not known
  bool known = true;  // others are left out

  template <class Value>
  Figure(std::string of, const Value& is, std::string called, std::string means = "",
         FigureUnit in = FigureUnit::none)
      : key(std::move(of)),
        name(std::move(called)),
        meaning(std::move(means)),
        unit(in),
        value(typed(is)) {}
  // Not known where there is none.
  template <class Value>
  Figure(std::string of, const std::optional<Value>& is, std::string called, std::string means = "",
         FigureUnit in = FigureUnit::none)
      : Figure(std::move(of), is.value_or(Value{}), std::move(called), std::move(means), in) {
    known = is.has_value();
  }

  // The same, not known unless `is`.
  Figure when(bool is) const;

 private:
  template <class Value>
  static FigureValue typed(const Value& is) {
    if constexpr (std::is_same_v<Value, bool>)
      return is;
    else if constexpr (std::is_unsigned_v<Value>)
      return static_cast<std::uint64_t>(is);
    else if constexpr (std::is_integral_v<Value>)
      return static_cast<std::int64_t>(is);
    else if constexpr (std::is_same_v<Value, Vec3>)
      return std::vector<double>{is.x, is.y, is.z};
    else if constexpr (std::is_same_v<Value, std::vector<Vec3>>)
      return coordinates(is);
    else if constexpr (std::is_convertible_v<Value, std::string>)
      return std::string(is);
    else
      return FigureValue(is);
  }
  static std::vector<double> coordinates(const std::vector<Vec3>& places);  // x, y, z of each
};

using Figures = std::vector<Figure>;

// All one after the other.
Figures together(std::initializer_list<Figures> parts);
// Those of a part: "stretch" before "p99" is "stretch.p99"; `name` before their names, and a comma.
Figures under(const std::string& key, const std::string& name, Figures figures);
// With this text before their keys: "boundary_" before "p99" is "boundary_p99".
Figures prefixed(const std::string& prefix, Figures figures);
// All unknown unless `is`.
Figures when(bool is, Figures figures);
// The ones of these keys, in their order. Throws Error where there is none: a fault of the program.
Figures only(const Figures& figures, std::initializer_list<std::string_view> keys);
// null: there is no known one of this key.
const Figure* findFigure(const Figures& figures, std::string_view key);

// NaN: not known. Throws Error for texts and lists: a fault of the program.
double numberOf(const Figure& figure);

// What the figures of one row are as columns of many: lists, to which more rows can be added.
Figures emptyColumns(const Figures& row);
void addRow(Figures& columns, const Figures& row);  // NaN, or an empty text: not known

// of(row) gives the figures of each row; these are lists of them. Rows are default constructible.
template <class Rows, class Of>
Figures columns(const Rows& rows, const Of& of) {
  Figures out = emptyColumns(of(typename Rows::value_type{}));
  for (const auto& row : rows) addRow(out, of(row));
  return out;
}

}  // namespace innermap
