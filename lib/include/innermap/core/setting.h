// One description of each field of a settings struct. Options of the program, keywords of Python,
// the library's checks and all that is written about them derive from it. It stands beside the
// struct:
//
//   struct SliceSettings { int count = 16; bool half = false; };
//
//   std::vector<Setting> describe(SliceSettings& s) {
//     return {Setting("count", "N", &s.count, "slices, evenly spaced").range(1, 65536),
//             Setting("half", &s.half, "half floats: half the size, three digits")};
//   }
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace innermap {

struct NumberRange {
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();
  bool lowerOpen = false;  // `lower` itself is not allowed

  bool holds(double value) const;  // false for what is not finite
  bool bounded() const;
  // "above 0", "from 4 to 4096", "of at least 2"; empty without a bound.
  std::string text() const;
  // What an error says of a value, as the user wrote it: "3 is out of range; give a number from 4
  // to 64 (voxels)". unit: may be empty.
  std::string refusal(const std::string& given, const std::string& unit) const;
};

// One of some words.
struct SettingChoice {
  std::vector<std::string> words;
  std::function<std::size_t()> now;  // number of the word
  std::function<void(std::size_t)> take;
};

using SettingValue =
    std::variant<bool*, int*, std::uint64_t*, double*, std::optional<int>*,
                 std::optional<std::uint64_t>*, std::optional<double>*, SettingChoice>;

struct Setting {
  // The keyword in Python, words joined by '_'; the option has '-' instead, and "--" in front.
  std::string name;
  std::string placeholder;  // "N"; empty for a flag
  SettingValue value;
  // One line, without a capital letter or a point; "{tolerance}" is another setting. Of a flag that
  // is on unless turned off: what turning it off does.
  std::string help;
  std::string unit;      // "degrees", or empty
  std::string fallback;  // what is taken where none is given, if the value does not tell
  NumberRange range;
  std::optional<double> automatic;  // this value means `fallback`, whatever the range
  bool advanced = false;            // not for every day
  std::string formerName;           // is still taken, with a note; empty: none

  Setting(std::string called, std::string stands, SettingValue at, std::string says)
      : name(std::move(called)),
        placeholder(std::move(stands)),
        value(std::move(at)),
        help(std::move(says)) {}
  Setting(std::string called, bool* flag, std::string says)
      : Setting(std::move(called), "", flag, std::move(says)) {}

  // Chained in a list of braces: each gives the setting, changed.
  Setting from(double lower, double upper) const;  // both allowed
  Setting above(double lower, double upper = std::numeric_limits<double>::infinity()) const;
  Setting in(std::string unit) const;
  Setting otherwise(std::string fallback) const;
  Setting otherwise(double automatic, std::string fallback) const;
  Setting rare() const;  // advanced
  Setting was(std::string formerName) const;
};

// words: the first that is *value is the default.
template <class Value>
SettingChoice choiceOf(Value* value, const std::vector<std::pair<std::string, Value>>& words) {
  SettingChoice out;
  for (const auto& [word, meaning] : words) out.words.push_back(word);
  out.now = [value, words] {
    for (std::size_t i = 0; i < words.size(); ++i)
      if (words[i].second == *value) return i;
    return std::size_t{0};
  };
  out.take = [value, words](std::size_t i) { *value = words.at(i).second; };
  return out;
}

// Of all random choices.
Setting seedSetting(std::uint64_t* seed);
// x, y or z.
Setting axisSetting(const std::string& name, int* axis, const std::string& help);

// The settings of `all` but for those of these names, or those alone, in the order of `all`. Throws
// Error where one has no such name: a fault of the program.
std::vector<Setting> without(std::vector<Setting> all, const std::vector<std::string>& names);
std::vector<Setting> only(std::vector<Setting> all, const std::vector<std::string>& names);

// The texts of `help` with each "{name}" as `shown` gives it.
std::string withNames(const std::string& help,
                      const std::function<std::string(const std::string&)>& shown);

// Throws SettingError for the first number that is out of its range.
void requireInRange(const std::vector<Setting>& settings);

// For structs with a describe().
template <class Settings>
void requireDescribed(Settings settings) {
  requireInRange(describe(settings));
}

}  // namespace innermap
