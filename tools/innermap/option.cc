#include "option.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <filesystem>

#include "command.h"
#include "core/file.h"
#include "innermap/io/pictures.h"
#include "lists.h"
#include "spelling.h"

namespace innermap::tool {
namespace {

std::string inUnit(const Option& option) {
  return option.unit.empty() ? "" : " (" + option.unit + ")";
}

[[noreturn]] void outOfRange(const Option& option, const std::string& text) {
  throw SettingError(option.name, option.range.refusal(text, option.unit));
}

// The whole text must be one number: no sign '+', no blanks, no nan or inf.
template <class T>
T parseNumber(const Option& option, const std::string& text, const char* what) {
  T value{};
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (error == std::errc::result_out_of_range && stop == end)
    throw SettingError(option.name,
                       "'" + text + "' is too large or too small a number" +
                           (option.range.bounded() ? "; give one " + option.range.text() : ""));
  bool good = error == std::errc() && stop == end;
  if constexpr (std::is_floating_point_v<T>) good = good && std::isfinite(value);
  if (!good)
    throw UsageError(fmt::format("{}: '{}' is not {}{}", option.name, text, what, inUnit(option)));
  const double number = static_cast<double>(value);
  if (number != option.automatic && !option.range.holds(number)) outOfRange(option, text);
  return value;
}

NumberPair parsePair(const Option& option, const std::string& text) {
  const std::vector<double> pair =
      parseNumbers(option.name, text, 2, "two numbers with a comma between");
  return {pair[0], pair[1]};
}

// A negative count is a number, but out of range: the message should say so.
std::uint64_t parseCount(const Option& option, const std::string& text) {
  if (!text.empty() && text[0] == '-') {
    Option anyRange = option;
    anyRange.range = {};
    parseNumber<std::int64_t>(anyRange, text, "a whole number");
    Option fromZero = option;
    fromZero.range.lower = std::max(0.0, option.range.lower);
    outOfRange(fromZero, text);
  }
  return parseNumber<std::uint64_t>(option, text, "a whole number");
}

// What is no regular file may be called anything: /dev/stdout.
void requireEnding(const Option& option, const std::string& text) {
  if (option.endings.empty() || fileKey(text).empty()) return;
  std::string name = std::filesystem::path(text).filename().string();
  for (char& c : name) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  for (const std::string& ending : option.endings)
    if (name.size() > ending.size() &&
        name.compare(name.size() - ending.size(), ending.size(), ending) == 0)
      return;
  throw UsageError(fmt::format("{}: '{}' must end in {}, as the file that is written does",
                               option.name, text, fmt::join(option.endings, " or ")));
}

std::string parseText(const Option& option, const std::string& text) {
  if (option.choices.empty()) {
    if (text.empty()) throw UsageError(option.name + ": is empty; give a value");
    requireEnding(option, text);
    return text;
  }
  for (const std::string& choice : option.choices)
    for (const std::string& spelling : spellings(choice))
      if (spelling == text) return choice;
  throw UsageError(fmt::format("{}: '{}' is not one of {}{}", option.name, text,
                               fmt::join(option.choices, ", "), didYouMean(text, option.choices)));
}

// Puts what the text says where an option's value goes.
struct Taker {
  const Option& option;
  const std::string& text;
  void operator()(bool* to) const { *to = option.sets; }
  void operator()(int* to) const { *to = parseNumber<int>(option, text, "a whole number"); }
  void operator()(std::uint64_t* to) const { *to = parseCount(option, text); }
  void operator()(double* to) const { *to = parseNumber<double>(option, text, "a number"); }
  void operator()(std::string* to) const { *to = parseText(option, text); }
  void operator()(const SettingChoice& to) const {
    const std::vector<std::string>& words = to.words;
    const auto found = std::find(words.begin(), words.end(), parseText(option, text));
    to.take(static_cast<std::size_t>(found - words.begin()));
  }
  void operator()(Cut* to) const { *to = parseCut(option.name, text, *to); }
  void operator()(NumberPair* to) const { *to = parsePair(option, text); }
  void operator()(std::vector<std::string>* to) const { to->push_back(parseText(option, text)); }
  template <class Value>
  void operator()(std::optional<Value>* to) const {
    Value value{};
    (*this)(&value);
    *to = value;
  }
};

}  // namespace

Cut parseCut(const std::string& name, const std::string& text, Cut cut) {
  const std::size_t equals = text.find('=');
  std::string axis = text.substr(0, equals), at;
  if (equals != std::string::npos)
    at = text.substr(equals + 1);
  else if (!axis.empty() && std::isalpha(static_cast<unsigned char>(axis[0])) == 0)
    std::swap(axis, at);
  if (axis.empty() && at.empty())
    throw UsageError(name + ": is empty; give an axis and a fraction, as in x=0.5");
  static const std::string kAxes = "xyz";
  if (axis == "auto")
    cut.axis.reset();
  else if (axis.size() > 1 || (!axis.empty() && kAxes.find(axis) == std::string::npos))
    throw UsageError(
        fmt::format("{}: '{}' is not an axis; give x, y or z, as in x=0.5", name, axis));
  else if (!axis.empty())
    cut.axis = static_cast<int>(kAxes.find(axis));
  if (at.empty() && equals == std::string::npos) return cut;
  Option fraction;
  fraction.name = name;
  fraction.range = {0, 1, false};
  fraction.unit = "fraction of the box";
  cut.at = parseNumber<double>(fraction, at, "a number");
  return cut;
}

bool arePartsOfACut(const std::vector<std::string>& texts) {
  if (texts.size() != 2) return false;
  const auto isAxis = [](const std::string& text) {
    return !text.empty() && std::isalpha(static_cast<unsigned char>(text[0])) != 0;
  };
  return isAxis(texts[0]) != isAxis(texts[1]) &&
         (texts[0] + texts[1]).find('=') == std::string::npos;
}

std::string textOf(const Cut& cut) {
  std::string out;
  if (cut.axis) out = axisName(*cut.axis);
  if (cut.at) out += fmt::format("{}{:g}", out.empty() ? "" : "=", *cut.at);
  return out;
}

void parseInto(const Option& option, const std::string& text) {
  std::visit(Taker{option, text}, option.target);
}

}  // namespace innermap::tool
