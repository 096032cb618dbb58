// What is known of an innermap.Cells: the shapes of its cells, and what is proven of them.
#include "bind/arrays.h"
#include "bind/cells.h"
#include "bind/figures.h"
#include "bind/keywords.h"
#include "innermap/tetra/cells.h"
#include "report/figures.h"

namespace py = pybind11;
using namespace py::literals;

namespace innermap::python {
namespace {

py::object quality(const Arguments& a, CallOptions& o) {
  const auto& cells = py::cast<const PyCells&>(a[0]);
  const CellQuality found = call(o, [&]() { return cellQuality(cells.mesh); });
  return py::dict("least_dihedral"_a = arrayOf(found.leastDihedral),
                  "greatest_dihedral"_a = arrayOf(found.greatestDihedral),
                  "scaled_jacobian"_a = arrayOf(found.scaledJacobian),
                  "inverted"_a = found.invertedTetrahedra + found.invertedHexahedra);
}

py::object prove(const Arguments& a, CallOptions& o) {
  const auto& cells = py::cast<const PyCells&>(a[0]);
  return python::dictOf(innermap::figures(call(o, [&]() {
    validate(cells.mesh);
    return proveCells(cells.mesh);
  })));
}

}  // namespace

void bindCellChecks(py::module_& m) {
  const py::object cells = m.attr("Cells");
  define<CallOptions>(cells,
                      {"quality", "self",
                       "Shapes of the cells: least_dihedral and greatest_dihedral of tetrahedra, "
                       "degrees, scaled_jacobian of hexahedra, arrays of one number a cell, and "
                       "inverted, how many are inside out."},
                      quality);
  define<CallOptions>(
      cells,
      {"prove", "self",
       "What is proven of the cells with their points as they are, by exact signs: a dict. "
       "statement, in words; right_side_out, whether all are; one_to_one, whether also no two "
       "overlap, which is shown for tetrahedra alone; not_right_side_out and undecided, how many "
       "cells; meetings, where the boundary meets itself; exact, how many signs took exact "
       "arithmetic."},
      prove);
}

}  // namespace innermap::python
