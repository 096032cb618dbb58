// The library's exceptions as Python's.
#pragma once

#include <pybind11/pybind11.h>

#include <string>

namespace innermap::python {

// innermap.Error and what derives from it.
void bindErrors(pybind11::module_& m);

// Of arguments: "X: expects an array of shape (n, 3), got (4,)". The first is a TypeError, the
// second an innermap.DataError, which is a ValueError.
[[noreturn]] void wrongType(const std::string& argument, const std::string& what);
[[noreturn]] void wrongValue(const std::string& argument, const std::string& what);

}  // namespace innermap::python
