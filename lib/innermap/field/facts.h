// What is known of a field or a map beside its numbers, as its file keeps it: keys of [a-z0-9_],
// each with a text without line breaks. Read here alone as what it stands for.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace innermap {

using Facts = std::vector<std::pair<std::string, std::string>>;

// Nothing where there is no such key; of numbers and flags also where the text is none.
std::optional<std::string> factText(const Facts& facts, std::string_view key);
std::optional<double> factNumber(const Facts& facts, std::string_view key);
std::optional<bool> factFlag(const Facts& facts, std::string_view key);

// As facts keep it: to the nine digits that tell figures apart.
std::string textOfFact(double number);
std::string textOfFact(bool flag);

}  // namespace innermap
