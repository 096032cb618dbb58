// innermap.Cells: tetrahedra and hexahedra with fields.
#pragma once

#include <pybind11/pybind11.h>

#include <string>
#include <vector>

#include "bind/call.h"
#include "innermap/lattice/cell_mesh.h"

namespace innermap::python {

void bindCells(pybind11::module_& m);
void bindCellChecks(pybind11::module_& m);  // after bindCells: Cells.quality(), prove()
void bindFill(pybind11::module_& m);        // after bindCells: solids filled with cells
void bindRemesh(pybind11::module_& m);      // after bindCells and bindMap
void bindCompareFem(pybind11::module_& m);

struct PyCells {
  CellMesh mesh;
  pybind11::dict figures;
};

pybind11::object cellsObject(CellMesh mesh, const pybind11::dict& figures = {});

// Whether cellsFrom() takes it, and no surface of triangles is meant.
bool isCells(pybind11::handle object);

// A Cells, the path of a .vtu, .msh or .mesh file, (points, cells) or an object with points and
// cells, such as meshio.Mesh. cells: a dict of arrays by type, or a list of (type, array) or of
// objects with type and data. vectors, normals: names of fields that are such.
CellMesh cellsFrom(const pybind11::object& object, const std::string& name, const CallOptions& call,
                   const std::vector<std::string>& vectors = {},
                   const std::vector<std::string>& normals = {});

}  // namespace innermap::python
