#include "bind/figures.h"

#include <fmt/format.h>

#include <cmath>

namespace py = pybind11;

namespace innermap::python {

py::dict factsOf(const Facts& facts) {
  py::dict out;
  for (const auto& [key, value] : facts) out[key.c_str()] = value;
  return out;
}

py::object toleranceMet(const Facts& facts) {
  const std::optional<bool> met = factFlag(facts, "tolerance_met");
  return met ? py::object(py::bool_(*met)) : py::none();
}

BoundaryError errorOf(const Facts& facts) {
  const auto number = [&](const char* key) {
    return factNumber(facts, std::string("boundary_error_") + key).value_or(std::nan(""));
  };
  BoundaryError out;
  out.rms = number("rms");
  out.p99 = number("p99");
  out.max = number("max");
  out.p99Bound = number("p99_bound");
  out.bound = number("bound");
  const double samples = number("samples");
  out.samples = samples >= 0 && samples < 1e15 ? static_cast<std::size_t>(samples) : 0;
  return out;
}

py::dict figuresOf(const Injectivity& known) {
  py::dict out;
  for (const auto& [name, value] : injectivityFigures(known))
    std::visit([&, &key = name](auto number) { out[key.c_str()] = number; }, value);
  return out;
}

void bindFigures(py::module_& m) {
  py::class_<BoundaryError>(
      m, "BoundaryError",
      "The error on the boundary, at random points of it that took no part in the fit. What is "
      "harmonic is nowhere farther off inside (maximum principle). Fractions: of the target's "
      "diagonal for maps, of the values' span for fields.")
      .def_readonly("rms", &BoundaryError::rms, "Root mean square.")
      .def_readonly("p99", &BoundaryError::p99, "99% of the boundary is within it.")
      .def_readonly("max", &BoundaryError::max,
                    "The largest that was met, also where the largest was looked for.")
      .def_readonly("p99_bound", &BoundaryError::p99Bound,
                    "With 95% confidence 99% of the boundary is within it.")
      .def_readonly("bound", &BoundaryError::bound, "With 95% confidence all of it is within it.")
      .def_readonly("samples", &BoundaryError::samples, "Points at which it was measured.")
      .def("__repr__", [](const BoundaryError& e) {
        return fmt::format(
            "<innermap.BoundaryError rms {:.3g}, 99% {:.3g}, max {:.3g}, at most "
            "{:.3g}>",
            e.rms, e.p99, e.max, e.bound);
      });
}

}  // namespace innermap::python
