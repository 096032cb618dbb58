// innermap.Field: a harmonic field with the solid that it fills.
#pragma once

#include <pybind11/pybind11.h>

#include <memory>
#include <optional>

#include "innermap/fit/fit_harmonic.h"

namespace innermap::python {

struct PyField {
  std::shared_ptr<const SolidField> solid;
  double span = 1;                 // of the values
  std::optional<HarmonicFit> fit;  // where it was fitted here

  double accuracy(double fraction) const { return fraction * span; }
  bool single() const { return solid->names.size() == 1; }
};

std::shared_ptr<PyField> fieldOf(SolidField solid);

void bindField(pybind11::module_& m);
void bindHarmonic(pybind11::module_& m);

}  // namespace innermap::python
