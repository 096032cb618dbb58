#include "bind/figures.h"

#include <fmt/format.h>

#include "bind/arrays.h"

namespace py = pybind11;

namespace innermap::python {

py::dict factsOf(const Facts& facts) {
  py::dict out;
  for (const auto& [key, value] : facts) out[key.c_str()] = value;
  return out;
}

namespace {

struct ObjectOf {
  py::object operator()(const std::vector<double>& list) const { return arrayOf(list); }
  template <class Value>
  py::object operator()(const Value& value) const {
    return py::cast(value);
  }
};

}  // namespace

py::dict dictOf(const Figures& figures) {
  py::dict out;
  for (const Figure& figure : figures) {
    if (!figure.known) continue;
    const std::string& key = figure.key;
    py::dict place = out;
    std::size_t from = 0;
    for (std::size_t dot; (dot = key.find('.', from)) != std::string::npos; from = dot + 1) {
      const py::str part(key.substr(from, dot - from));
      if (!place.contains(part)) place[part] = py::dict();
      place = place[part].cast<py::dict>();
    }
    place[py::str(key.substr(from))] = std::visit(ObjectOf(), figure.value);
  }
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
      .def_readonly("bound", &BoundaryError::bound,
                    "An estimate: all of it is within it. Map.prove() bounds it.")
      .def_readonly("samples", &BoundaryError::samples, "Points at which it was measured.")
      .def("__repr__", [](const BoundaryError& e) {
        return fmt::format(
            "<innermap.BoundaryError rms {:.3g}, 99% {:.3g}, max {:.3g}, at most "
            "{:.3g}>",
            e.rms, e.p99, e.max, e.bound);
      });
}

}  // namespace innermap::python
