#include "innermap/core/setting.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "core/require_number.h"
#include "innermap/core/error.h"

namespace innermap {
namespace {

constexpr double kEndless = 1e300;

std::string digits(double value) { return fmt::format("{:.15g}", value); }

// The number that a setting has, if it is a number and has one.
struct NumberOf {
  std::optional<double> operator()(const bool*) const { return {}; }
  std::optional<double> operator()(const SettingChoice&) const { return {}; }
  template <class Value>
  std::optional<double> operator()(const Value* value) const {
    if constexpr (std::is_arithmetic_v<Value>) {
      return static_cast<double>(*value);
    } else {
      if (!*value) return {};
      return static_cast<double>(**value);
    }
  }
};

bool named(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

void requireAll(const std::vector<Setting>& all, const std::vector<std::string>& names) {
  for (const std::string& name : names)
    if (std::none_of(all.begin(), all.end(), [&](const Setting& s) { return s.name == name; }))
      throw Error("no setting is called " + name);
}

}  // namespace

bool NumberRange::holds(double value) const {
  return std::isfinite(value) && value <= upper && (lowerOpen ? value > lower : value >= lower);
}

bool NumberRange::bounded() const { return lower > -kEndless || upper < kEndless; }

std::string NumberRange::text() const {
  const bool below = lower > -kEndless, above = upper < kEndless;
  if (below && lowerOpen)
    return "above " + digits(lower) + (above ? " up to " + digits(upper) : "");
  if (below && above) return "from " + digits(lower) + " to " + digits(upper);
  if (below) return "of at least " + digits(lower);
  return above ? "of at most " + digits(upper) : "";
}

std::string NumberRange::refusal(const std::string& given, const std::string& unit) const {
  return fmt::format("{} is out of range; give a {}{}", given,
                     bounded() ? "number " + text() : "finite number",
                     unit.empty() ? "" : " (" + unit + ")");
}

Setting Setting::from(double lower, double upper) const {
  Setting out = *this;
  out.range = {lower, upper, false};
  return out;
}

Setting Setting::above(double lower, double upper) const {
  Setting out = *this;
  out.range = {lower, upper, true};
  return out;
}

Setting Setting::in(std::string text) const {
  Setting out = *this;
  out.unit = std::move(text);
  return out;
}

Setting Setting::otherwise(std::string text) const {
  Setting out = *this;
  out.fallback = std::move(text);
  return out;
}

Setting Setting::otherwise(double number, std::string text) const {
  Setting out = otherwise(std::move(text));
  out.automatic = number;
  return out;
}

Setting Setting::rare() const {
  Setting out = *this;
  out.advanced = true;
  return out;
}

Setting Setting::was(std::string former) const {
  Setting out = *this;
  out.formerName = std::move(former);
  return out;
}

Setting seedSetting(std::uint64_t* seed) {
  return Setting("seed", "N", seed, "seed of all random choices").from(0, 1e15).rare();
}

Setting axisSetting(const std::string& name, int* axis, const std::string& help) {
  return {name, "AXIS", choiceOf<int>(axis, {{"x", 0}, {"y", 1}, {"z", 2}}), help};
}

std::vector<Setting> without(std::vector<Setting> all, const std::vector<std::string>& names) {
  requireAll(all, names);
  all.erase(std::remove_if(all.begin(), all.end(),
                           [&](const Setting& s) { return named(names, s.name); }),
            all.end());
  return all;
}

std::vector<Setting> only(std::vector<Setting> all, const std::vector<std::string>& names) {
  requireAll(all, names);
  all.erase(std::remove_if(all.begin(), all.end(),
                           [&](const Setting& s) { return !named(names, s.name); }),
            all.end());
  return all;
}

std::string withNames(const std::string& help,
                      const std::function<std::string(const std::string&)>& shown) {
  std::string out;
  std::size_t at = 0;
  while (at < help.size()) {
    const std::size_t open = help.find('{', at), close = help.find('}', open);
    if (open == std::string::npos || close == std::string::npos) break;
    out += help.substr(at, open - at) + shown(help.substr(open + 1, close - open - 1));
    at = close + 1;
  }
  return out + help.substr(at);
}

void requireInRange(const std::vector<Setting>& settings) {
  for (const Setting& s : settings) {
    const std::optional<double> number = std::visit(NumberOf{}, s.value);
    if (number && number != s.automatic) requireNumber(s.name, *number, s.range, s.unit);
  }
}

void requireNumber(const std::string& name, double value, const NumberRange& range,
                   const std::string& unit) {
  if (!range.holds(value))
    throw SettingError(name, range.refusal(fmt::format("{:g}", value), unit));
}

}  // namespace innermap
