// Texts and lists as arguments.
#pragma once

#include <pybind11/pybind11.h>

#include <cstdint>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace innermap::python {

// A str, in UTF-8. Throw TypeError for what is none, DataError for half a surrogate pair.
std::string textFrom(pybind11::handle object, const std::string& name);
// str(object).
std::string textOf(pybind11::handle object, const std::string& name);
// One text or several; none for None. Throws TypeError for what is no text.
std::vector<std::string> textsFrom(pybind11::handle object, const std::string& name);
// One number or several, finite; none for None.
std::vector<double> numbersFrom(pybind11::handle object, const std::string& name);
// One whole number or several in [0, 1e9].
std::vector<std::int64_t> countsFrom(pybind11::handle object, const std::string& name);
// For a setting that is a list of numbers: it stays as it is for None.
template <class Number>
void takeNumbers(const pybind11::object& given, const std::string& name, std::vector<Number>& to) {
  if (given.is_none()) return;
  if constexpr (std::is_integral_v<Number>) {
    const auto counts = countsFrom(given, name);
    to.assign(counts.begin(), counts.end());
  } else {
    to = numbersFrom(given, name);
  }
}
// Exactly two, as (least, most).
std::pair<double, double> pairFrom(pybind11::handle object, const std::string& name);

}  // namespace innermap::python
