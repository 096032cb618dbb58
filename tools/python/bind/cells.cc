#include "bind/cells.h"

#include <fmt/format.h>
#include <pybind11/numpy.h>

#include <algorithm>

#include "bind/arrays.h"
#include "bind/errors.h"
#include "bind/keywords.h"
#include "bind/lists.h"
#include "bind/meshes.h"
#include "innermap/io/cell_file.h"

namespace py = pybind11;

namespace innermap::python {
namespace {

// meshio's names, as Gmsh's and VTK's cells.
constexpr char kTetra[] = "tetra", kHexahedron[] = "hexahedron";

struct Block {
  std::string type;
  py::object data;
};

std::vector<Block> blocksOf(const py::object& cells, const std::string& name) {
  std::vector<Block> out;
  if (py::isinstance<py::dict>(cells)) {
    for (const auto& [type, data] : py::dict(cells))
      out.push_back({textOf(type, name), py::reinterpret_borrow<py::object>(data)});
    return out;
  }
  for (const auto& item : cells) {
    if (py::hasattr(item, "type") && py::hasattr(item, "data"))
      out.push_back({textOf(item.attr("type"), name), item.attr("data")});
    else if (py::isinstance<py::tuple>(item) && py::len(item) == 2)
      out.push_back({textOf(item[py::int_(0)], name), item[py::int_(1)]});
    else
      wrongValue(name, "expects cells as a dict of arrays by type, or a list of (type, array)");
  }
  return out;
}

template <std::size_t N>
void takeCells(const py::object& data, const std::string& name, std::size_t vertices,
               std::vector<std::array<int, N>>& to) {
  const py::array array = py::array::ensure(data);
  if (!array || array.ndim() != 2 || array.shape(1) != static_cast<py::ssize_t>(N))
    wrongValue(name, fmt::format("expects an array of shape (n, {})", N));
  const std::vector<std::int64_t> flat =
      wholesFrom(array.attr("ravel")(), name, 0, static_cast<std::int64_t>(vertices) - 1);
  for (std::size_t i = 0; i < flat.size(); i += N) {
    std::array<int, N> cell;
    for (std::size_t c = 0; c < N; ++c) cell[c] = static_cast<int>(flat[i + c]);
    to.push_back(cell);
  }
}

bool isFilling(const std::string& type) { return type == kTetra || type == kHexahedron; }

bool isLower(const std::string& type) {
  return type == "vertex" || type == "line" || type == "triangle" || type == "quad";
}

CellField::Kind kindOf(const std::string& field, const std::vector<std::string>& vectors,
                       const std::vector<std::string>& normals) {
  const auto has = [&](const std::vector<std::string>& names) {
    return std::find(names.begin(), names.end(), field) != names.end();
  };
  return has(vectors)   ? CellField::Kind::vector
         : has(normals) ? CellField::Kind::normal
                        : CellField::Kind::scalar;
}

CellField fieldOf(const std::string& field, const py::handle& values, std::size_t rows) {
  const py::array array = py::array::ensure(py::reinterpret_borrow<py::object>(values));
  if (!array || array.ndim() < 1) wrongValue(field, "expects an array");
  const std::size_t count = static_cast<std::size_t>(array.shape(0));
  CellField out;
  out.name = field;
  out.whole = array.dtype().kind() == 'i' || array.dtype().kind() == 'u';
  if (count == 0 && rows == 0) return out;
  // Rows of more axes (3 x 3 tensors) are laid out one after another.
  const py::object flat = array.attr("reshape")(count, -1);
  const Matrix matrix = matrixFrom(flat, field, rows, true);
  out.components = static_cast<int>(matrix.columns());
  for (std::size_t i = 0; i < matrix.rows(); ++i)
    for (std::size_t k = 0; k < matrix.columns(); ++k) out.values.push_back(matrix(i, k));
  return out;
}

py::array arrayOfField(const CellField& field, std::size_t first, std::size_t rows) {
  const auto k = static_cast<std::size_t>(field.components);
  std::vector<py::ssize_t> shape{static_cast<py::ssize_t>(rows)};
  if (k > 1) shape.push_back(static_cast<py::ssize_t>(k));
  const double* from = field.values.data() + first * k;
  if (!field.whole) return py::array_t<double>(shape, from);
  py::array_t<std::int64_t> out(shape);
  std::transform(from, from + rows * k, out.mutable_data(),
                 [](double v) { return static_cast<std::int64_t>(v); });
  return std::move(out);
}

// Of several blocks in the mesh's order: tetrahedra, then hexahedra.
void takeCellData(const py::dict& data, const std::vector<Block>& blocks, CellMesh& mesh) {
  for (const auto& [key, values] : data) {
    const std::string name = textOf(key, "cell_data");
    const py::list parts(py::reinterpret_borrow<py::object>(values));
    if (parts.size() != blocks.size())
      wrongValue(name, fmt::format("cell_data has {} arrays, there are {} blocks of cells",
                                   parts.size(), blocks.size()));
    py::list ordered;
    for (const char* type : {kTetra, kHexahedron})
      for (std::size_t b = 0; b < blocks.size(); ++b)
        if (blocks[b].type == type) ordered.append(parts[b]);
    mesh.cellFields.push_back(fieldOf(name,
                                      py::module_::import("numpy").attr("concatenate")(ordered),
                                      mesh.tetrahedra.size() + mesh.hexahedra.size()));
  }
}

py::dict dictOf(const py::object& object, const char* attribute) {
  if (!py::hasattr(object, attribute)) return {};
  const py::object value = object.attr(attribute);
  return value.is_none() ? py::dict() : py::dict(value);
}

CellMesh meshOf(const py::object& points, const py::object& cells, const py::dict& pointData,
                const py::dict& cellData, const std::string& name) {
  CellMesh mesh;
  mesh.name = name;
  mesh.vertices = pointsFrom(points, name + ".points");
  const std::vector<Block> blocks = blocksOf(cells, name);
  for (const auto& [type, data] : blocks) {
    const std::string label = fmt::format("{}.cells of type '{}'", name, type);
    if (type == kTetra)
      takeCells(data, label, mesh.vertices.size(), mesh.tetrahedra);
    else if (type == kHexahedron)
      takeCells(data, label, mesh.vertices.size(), mesh.hexahedra);
    else if (!isLower(type))
      wrongValue(name, "has cells of type '" + type + "'; takes 'tetra' and 'hexahedron'");
  }
  if (mesh.tetrahedra.empty() && mesh.hexahedra.empty())
    wrongValue(name, "has no cells of type 'tetra' or 'hexahedron'");
  for (const auto& [key, values] : pointData)
    mesh.vertexFields.push_back(fieldOf(textOf(key, "point_data"), values, mesh.vertices.size()));
  takeCellData(cellData, blocks, mesh);
  validate(mesh);
  return mesh;
}

CellMesh bareCells(const py::object& object, const std::string& name, const CallOptions& options) {
  if (py::isinstance<PyCells>(object)) return py::cast<const PyCells&>(object).mesh;
  if (isPath(object)) {
    const std::string path = pathFrom(object, name);
    return call(options, [&]() { return readCells(path).mesh; });
  }
  if (py::isinstance<py::tuple>(object)) {
    const py::tuple pair(object);
    if (pair.size() != 2) wrongValue(name, "expects a tuple (points, cells)");
    return meshOf(pair[0], pair[1], {}, {}, name);
  }
  if (py::hasattr(object, "points") && py::hasattr(object, "cells"))
    return meshOf(object.attr("points"), object.attr("cells"), dictOf(object, "point_data"),
                  dictOf(object, "cell_data"), name);
  wrongType(name,
            "expects cells: an innermap.Cells, a path, a tuple (points, cells) or an object with "
            "points and cells");
}

py::list blocksOut(const CellMesh& mesh) {
  const auto array = [](const auto& cells, std::size_t corners) {
    return py::array_t<std::int32_t>(
        {static_cast<py::ssize_t>(cells.size()), static_cast<py::ssize_t>(corners)},
        cells.empty() ? nullptr : cells.front().data());
  };
  py::list out;
  if (!mesh.tetrahedra.empty()) out.append(py::make_tuple(kTetra, array(mesh.tetrahedra, 4)));
  if (!mesh.hexahedra.empty()) out.append(py::make_tuple(kHexahedron, array(mesh.hexahedra, 8)));
  return out;
}

py::dict pointDataOf(const CellMesh& mesh) {
  py::dict out;
  for (const CellField& f : mesh.vertexFields)
    out[f.name.c_str()] = arrayOfField(f, 0, mesh.vertices.size());
  return out;
}

py::dict cellDataOf(const CellMesh& mesh) {
  py::dict out;
  const std::size_t tetrahedra = mesh.tetrahedra.size(), hexahedra = mesh.hexahedra.size();
  for (const CellField& f : mesh.cellFields) {
    py::list parts;
    if (tetrahedra > 0) parts.append(arrayOfField(f, 0, tetrahedra));
    if (hexahedra > 0) parts.append(arrayOfField(f, tetrahedra, hexahedra));
    out[f.name.c_str()] = parts;
  }
  return out;
}

py::object meshioOf(const PyCells& cells) {
  return py::module_::import("meshio").attr("Mesh")(arrayOf(cells.mesh.vertices),
                                                    blocksOut(cells.mesh),
                                                    py::arg("point_data") = pointDataOf(cells.mesh),
                                                    py::arg("cell_data") = cellDataOf(cells.mesh));
}

Mesh surfaceOf(const PyCells& cells) {
  Mesh mesh;
  mesh.name = cells.mesh.name;
  std::vector<int> number(cells.mesh.vertices.size(), -1);
  mesh.triangles = boundaryTriangles(cells.mesh);
  for (Triangle& t : mesh.triangles)
    for (int& v : t) {
      int& own = number[static_cast<std::size_t>(v)];
      if (own < 0) {
        own = static_cast<int>(mesh.vertices.size());
        mesh.vertices.push_back(cells.mesh.vertices[static_cast<std::size_t>(v)]);
      }
      v = own;
    }
  return mesh;
}

py::object writeCells(const Arguments& a, NoOptions&) {
  const auto& cells = py::cast<const PyCells&>(a[0]);
  const std::string path = pathFrom(a[1], "path");
  std::vector<std::string> left;
  {
    const py::gil_scoped_release unlocked;
    left = writeCells(path, cells.mesh);
  }
  return py::cast(left);
}

}  // namespace

py::object cellsObject(CellMesh mesh, const py::dict& figures) {
  return py::cast(std::make_shared<PyCells>(PyCells{std::move(mesh), figures}));
}

bool isCells(py::handle object) {
  if (py::isinstance<PyCells>(object)) return true;
  if (isPath(object)) return isCellFile(pathFrom(object, "cells"));
  if (py::isinstance<py::tuple>(object) && py::len(object) == 2) {
    const py::tuple pair(py::reinterpret_borrow<py::tuple>(object));
    if (py::isinstance<py::dict>(pair[1])) return true;
    return py::isinstance<py::list>(pair[1]) && py::len(pair[1]) > 0 &&
           py::isinstance<py::tuple>(py::list(pair[1])[0]);
  }
  if (!py::hasattr(object, "points") || !py::hasattr(object, "cells")) return false;
  const auto blocks = blocksOf(object.attr("cells"), "cells");
  return std::any_of(blocks.begin(), blocks.end(),
                     [](const Block& b) { return isFilling(b.type); });
}

CellMesh cellsFrom(const py::object& object, const std::string& name, const CallOptions& options,
                   const std::vector<std::string>& vectors,
                   const std::vector<std::string>& normals) {
  CellMesh mesh = bareCells(object, name, options);
  const auto mark = [&](std::vector<CellField>& fields) {
    for (CellField& f : fields) {
      const CellField::Kind kind = kindOf(f.name, vectors, normals);
      if (kind == CellField::Kind::scalar) continue;
      if (f.components != 3)
        wrongValue(name, fmt::format("field '{}' has {} components; a direction has three", f.name,
                                     f.components));
      f.kind = kind;
    }
  };
  mark(mesh.vertexFields);
  mark(mesh.cellFields);
  return mesh;
}

void bindCells(py::module_& m) {
  py::class_<PyCells, std::shared_ptr<PyCells>> cells(
      m, "Cells",
      "Tetrahedra and hexahedra with fields on points and cells, in meshio's terms: "
      "meshio.Mesh(c.points, c.cells, c.point_data, c.cell_data), or c.to_meshio().");
  cells
      .def_property_readonly(
          "points", [](const PyCells& c) { return arrayOf(c.mesh.vertices); },
          "(n, 3) float64, world units.")
      .def_property_readonly(
          "cells", [](const PyCells& c) { return blocksOut(c.mesh); },
          "A list of blocks (type, array): 'tetra' (m, 4), 'hexahedron' (m, 8), int32.")
      .def_property_readonly(
          "cells_dict", [](const PyCells& c) { return py::dict(blocksOut(c.mesh)); },
          "The blocks' arrays by type.")
      .def_property_readonly(
          "point_data", [](const PyCells& c) { return pointDataOf(c.mesh); },
          "Fields on points by name: (n,) or (n, k).")
      .def_property_readonly(
          "cell_data", [](const PyCells& c) { return cellDataOf(c.mesh); },
          "Fields on cells by name: a list of arrays, one a block.")
      .def_readonly("figures", &PyCells::figures,
                    "What the function that made it found out, by name.")
      .def("to_meshio", &meshioOf,
           documented("to_meshio(self)", "As a meshio.Mesh. Raises ImportError without meshio.")
               .c_str())
      .def("surface", &surfaceOf,
           documented("surface(self)", "The boundary as an innermap.Mesh, outward.").c_str())
      .def("__repr__", [](const PyCells& c) {
        return fmt::format("<innermap.Cells: {} vertices, {} tetrahedra, {} hexahedra>",
                           c.mesh.vertices.size(), c.mesh.tetrahedra.size(),
                           c.mesh.hexahedra.size());
      });
  define<NoOptions>(cells,
                    {"write", "self, path",
                     "Writes a .vtu, .msh (Gmsh 4.1) or .mesh (MEDIT) file, whole or not at all. "
                     "Returns the names of fields that the format cannot hold. Raises FileError."},
                    writeCells);
  define<CallOptions>(m,
                      {"read_cells", "path",
                       "Reads tetrahedra and hexahedra of a .vtu, .msh or .mesh file: an "
                       "innermap.Cells. Raises FileError, MemoryError."},
                      [](const Arguments& a, CallOptions& o) {
                        if (!isPath(a[0])) wrongType("path", "expects a path");
                        return cellsObject(cellsFrom(a[0], "path", o));
                      });
}

}  // namespace innermap::python
