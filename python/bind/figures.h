// Figures of the library as Python has them.
#pragma once

#include <pybind11/pybind11.h>

#include <optional>
#include <string>

#include "innermap/boundary/injectivity.h"
#include "innermap/field/boundary_error.h"
#include "innermap/field/field_file.h"

namespace innermap::python {

void bindFigures(pybind11::module_& m);

// What a file says of itself.
pybind11::dict factsOf(const Facts& facts);
// Of what a fit to a tolerance says; None where there was none.
pybind11::object toleranceMet(const Facts& facts);
// From a map's or a field's facts; NaN where they say nothing.
BoundaryError errorOf(const Facts& facts);

pybind11::dict figuresOf(const Injectivity& known);

}  // namespace innermap::python
