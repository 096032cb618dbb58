// What all that fills a solid can say of it.
#pragma once

#include <pybind11/pybind11.h>

#include <functional>

#include "innermap/levelset/solid.h"

namespace innermap::python {

// Defines `contains(X)` of a class. solidOf: called with the object.
void defineContains(pybind11::handle scope,
                    const std::function<Solid(const pybind11::object&)>& solidOf);

}  // namespace innermap::python
