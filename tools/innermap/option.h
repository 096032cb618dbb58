// One option or argument of a command: all that parsing, help and docs/commands.md say of it.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "innermap/core/setting.h"

namespace innermap::tool {

// Two numbers, "LO,HI" on the command line.
using NumberPair = std::pair<double, double>;

// A plane across a box: "x=0.5" on the command line, an axis and the fraction of the box along it;
// either may be left out.
struct Cut {
  std::optional<int> axis;
  std::optional<double> at;
};
constexpr const char* kCutPlaceholder = "AXIS=T";

// Adds what the text says, "x=0.5", "x", "0.5" or "auto", to `cut`; the name is the option's.
// Throws UsageError, SettingError.
Cut parseCut(const std::string& name, const std::string& text, Cut cut);
std::string textOf(const Cut& cut);
// Whether the texts are an axis and a fraction, as the two former options of a cut said them.
bool arePartsOfACut(const std::vector<std::string>& texts);

// Where the value goes. std::uint64_t serves std::size_t too. A list is for the last positional
// argument alone, which then takes all that follow. No std::function stands here by itself:
// libstdc++ 12 destroys what it never made where copying one in a variant throws.
using Target =
    std::variant<bool*, int*, std::uint64_t*, double*, std::string*, std::optional<int>*,
                 std::optional<std::uint64_t>*, std::optional<double>*, std::optional<NumberPair>*,
                 std::vector<std::string>*, Cut*, SettingChoice>;

struct Option {
  std::string name;         // "--voxel-size"; a positional argument's is in capitals: "MESH"
  std::string formerName;   // is still taken, with a note; several with commas between; or empty
  std::string shortName;    // "-o", or empty
  std::string placeholder;  // "LENGTH"; empty for a flag
  std::string unit;         // "world units", or empty
  std::string help;
  std::string defaultText;  // empty: none worth telling
  std::string group;        // the title that it stands under; empty: "options"
  bool required = false;
  bool advanced = false;  // only --help-all tells of it
  std::vector<std::string> choices;
  std::vector<std::string> endings;  // ".vdb": of the file that is written
  NumberRange range;
  std::optional<double> automatic;  // this value is as if the option were left out
  bool isInput = false;             // names a file that is read
  bool sets = true;                 // what a flag sets its target to
  Target target;

  std::string impliedValue;  // "--html" alone means this, "--html=FILE" that; empty: needs a value

  bool isFlag() const { return std::holds_alternative<bool*>(target); }
  bool isList() const { return std::holds_alternative<std::vector<std::string>*>(target); }
  bool isPositional() const { return name[0] != '-'; }
};

// Chained after Command::option(...): .unit("world units").above(0).defaults("from --resolution")
class OptionBuilder {
 public:
  // The option is named by its place: the table may still grow.
  OptionBuilder(std::vector<Option>& table, std::size_t index) : table_(table), index_(index) {}

  OptionBuilder& unit(std::string text) { return set(&Option::unit, std::move(text)); }
  OptionBuilder& shortName(std::string text) { return set(&Option::shortName, std::move(text)); }
  // By default the bound variable's value when registered is shown, if it is a number or text.
  OptionBuilder& defaults(std::string text) { return set(&Option::defaultText, std::move(text)); }
  OptionBuilder& was(std::string name) { return set(&Option::formerName, std::move(name)); }
  OptionBuilder& choices(std::vector<std::string> names) {
    return set(&Option::choices, std::move(names));
  }
  OptionBuilder& optional() { return set(&Option::required, false); }  // positional arguments
  // Names a file that is read, as positional arguments do: no output may be that file.
  OptionBuilder& reads() { return set(&Option::isInput, true); }
  // May stand without a value, which then is this one; with one it is written --name=VALUE.
  OptionBuilder& implied(std::string value) { return set(&Option::impliedValue, std::move(value)); }
  OptionBuilder& required() { return set(&Option::required, true); }
  // Not for every day: --help leaves it out, --help-all does not.
  OptionBuilder& advanced() { return set(&Option::advanced, true); }
  // Names a file that is written; names with other endings are refused.
  OptionBuilder& writes(std::vector<std::string> endings) {
    return set(&Option::endings, std::move(endings));
  }
  OptionBuilder& range(double lower, double upper) {
    table_[index_].range = {lower, upper, false};
    return *this;
  }
  OptionBuilder& atLeast(double lower) {
    return range(lower, std::numeric_limits<double>::infinity());
  }
  OptionBuilder& above(double lower) {
    table_[index_].range.lower = lower;
    table_[index_].range.lowerOpen = true;
    return *this;
  }
  OptionBuilder& atMost(double upper) {
    table_[index_].range.upper = upper;
    return *this;
  }

 private:
  template <class T, class U>
  OptionBuilder& set(T Option::*member, U&& value) {
    table_[index_].*member = std::forward<U>(value);
    return *this;
  }
  std::vector<Option>& table_;
  std::size_t index_;
};

// Parses `text` into the option's target. Throws UsageError for what is not a number, a whole
// number, one of the choices or a file's name with one of the endings, SettingError for a value out
// of range.
void parseInto(const Option& option, const std::string& text);

}  // namespace innermap::tool
