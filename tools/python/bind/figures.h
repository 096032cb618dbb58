// Figures of the library as Python has them.
#pragma once

#include <pybind11/pybind11.h>

#include "core/figure.h"
#include "innermap/field/field_file.h"

namespace innermap::python {

void bindFigures(pybind11::module_& m);

// What a file says of itself.
pybind11::dict factsOf(const Facts& facts);

// Of a result: parts are dicts in it, lists arrays; what is not known is left out.
pybind11::dict dictOf(const Figures& figures);

}  // namespace innermap::python
