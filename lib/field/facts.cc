#include <fmt/format.h>

#include <charconv>

#include "innermap/field/field_file.h"

namespace innermap {

std::optional<std::string> factText(const Facts& facts, std::string_view key) {
  for (const auto& [name, text] : facts)
    if (name == key) return text;
  return {};
}

std::optional<double> factNumber(const Facts& facts, std::string_view key) {
  const std::optional<std::string> text = factText(facts, key);
  if (!text) return {};
  double value = 0;
  const char* const last = text->data() + text->size();
  const auto [end, error] = std::from_chars(text->data(), last, value);
  if (error != std::errc() || end != last) return {};
  return value;
}

std::optional<bool> factFlag(const Facts& facts, std::string_view key) {
  const std::optional<std::string> text = factText(facts, key);
  if (!text || (*text != textOfFact(true) && *text != textOfFact(false))) return {};
  return *text == textOfFact(true);
}

std::string textOfFact(double number) { return fmt::format("{:.9g}", number); }

std::string textOfFact(bool flag) { return flag ? "true" : "false"; }

}  // namespace innermap
