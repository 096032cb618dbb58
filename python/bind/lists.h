// Lists as arguments.
#pragma once

#include <pybind11/pybind11.h>

#include <string>
#include <utility>
#include <vector>

namespace innermap::python {

// One text or several; none for None. Throws TypeError for what is no text.
std::vector<std::string> textsFrom(pybind11::handle object, const std::string& name);
// One number or several, finite; none for None.
std::vector<double> numbersFrom(pybind11::handle object, const std::string& name);
// Exactly two, as (least, most).
std::pair<double, double> pairFrom(pybind11::handle object, const std::string& name);

}  // namespace innermap::python
