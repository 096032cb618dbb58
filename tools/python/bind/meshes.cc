#include "bind/meshes.h"

#include <fmt/format.h>

#include "bind/arrays.h"
#include "bind/call.h"
#include "bind/errors.h"
#include "bind/lists.h"
#include "innermap/mesh/mesh_file.h"

namespace py = pybind11;

namespace innermap::python {
namespace {

Mesh meshOf(py::handle vertices, py::handle triangles, const std::string& name,
            const std::string& v, const std::string& f) {
  Mesh mesh;
  mesh.name = name;
  mesh.vertices = pointsFrom(vertices, v);
  if (mesh.vertices.empty()) wrongValue(v, "is empty; a mesh has vertices");
  mesh.triangles = trianglesFrom(triangles, f, mesh.vertices.size());
  if (mesh.triangles.empty()) wrongValue(f, "is empty; a mesh has triangles");
  requireNearOrigin(mesh);
  return mesh;
}

// Of meshio: blocks with a type and an array of cells.
py::object trianglesOfCells(const py::object& mesh, const std::string& name) {
  py::list arrays;
  for (const auto& block : mesh.attr("cells")) {
    const std::string type = textOf(block.attr("type"), name);
    if (type == "vertex" || type == "line") continue;
    if (type != "triangle")
      wrongValue(name, "has cells of type '" + type +
                           "'; a surface of triangles is wanted (quads: write them to a file)");
    arrays.append(block.attr("data"));
  }
  if (arrays.empty()) wrongValue(name, "has no triangles");
  return py::module_::import("numpy").attr("concatenate")(arrays);
}

py::str meshText(const Mesh& mesh) {
  return py::str(fmt::format("<innermap.Mesh '{}': {} vertices, {} triangles>", mesh.name,
                             mesh.vertices.size(), mesh.triangles.size()));
}

void bindMeshClass(py::module_& m) {
  py::class_<Mesh, std::shared_ptr<Mesh>>(
      m, "Mesh",
      "A mesh as read_mesh() gives it: polygons, texture coordinates and colours of its file stay "
      "with it. V, F = mesh has its arrays.")
      .def_readonly("name", &Mesh::name, "The file's path, or what messages call it.")
      .def_property_readonly(
          "vertices", [](const Mesh& mesh) { return arrayOf(mesh.vertices); },
          "(n, 3) float64, world units.")
      .def_property_readonly(
          "triangles", [](const Mesh& mesh) { return arrayOf(mesh.triangles); },
          "(m, 3) int32, counted from 0.")
      .def("__iter__",
           [](const Mesh& mesh) {
             return py::iter(py::make_tuple(arrayOf(mesh.vertices), arrayOf(mesh.triangles)));
           })
      .def("__repr__", &meshText);
}

}  // namespace

bool isPath(py::handle object) {
  return py::isinstance<py::str>(object) || py::hasattr(object, "__fspath__");
}

std::string pathFrom(py::handle object, const std::string& name) {
  if (!isPath(object)) wrongType(name, "expects a path (str or os.PathLike)");
  const std::string path = py::bytes(py::module_::import("os").attr("fsencode")(object));
  if (path.find('\0') != std::string::npos) wrongValue(name, "has a zero byte, as no path has");
  return path;
}

Mesh meshFrom(const py::object& object, const std::string& name) {
  if (py::isinstance<Mesh>(object)) return py::cast<const Mesh&>(object);
  if (isPath(object)) {
    const std::string path = pathFrom(object, name);
    return call(CallOptions(), [&]() { return readMesh(path); });
  }
  if (py::isinstance<py::tuple>(object)) {
    const py::tuple pair(object);
    if (pair.size() != 2) wrongValue(name, "expects a tuple (V, F)");
    return meshOf(pair[0], pair[1], name, name + "'s V", name + "'s F");
  }
  if (py::hasattr(object, "points") && py::hasattr(object, "cells"))
    return meshOf(object.attr("points"), trianglesOfCells(object, name), name, name + ".points",
                  name + ".cells");
  if (py::hasattr(object, "vertices") && py::hasattr(object, "faces"))
    return meshOf(object.attr("vertices"), object.attr("faces"), name, name + ".vertices",
                  name + ".faces");
  wrongType(name,
            "expects a mesh: V and F, a tuple (V, F), a path, an innermap.Mesh or an object with "
            "points and cells");
}

Mesh takeMesh(const Arguments& arguments, std::size_t& at, const std::string& name) {
  if (at >= arguments.size()) throw py::type_error("lacks the mesh '" + name + "'");
  const py::object& first = arguments[at++];
  if (!isArrayLike(first)) return meshFrom(first, name);
  if (at >= arguments.size())
    throw py::type_error(name + ": vertices without triangles; give V, F or a tuple (V, F)");
  return meshOf(first, arguments[at++], name, "V", "F");
}

Mesh onlyMesh(const Arguments& arguments, const std::string& function) {
  std::size_t at = 0;
  Mesh mesh = takeMesh(arguments, at, "mesh");
  if (at < arguments.size()) throw py::type_error(function + "() takes one mesh");
  return mesh;
}

Mesh takeTarget(const Arguments& arguments, std::size_t& at, const Mesh& source) {
  const py::object& given = arguments[at++];
  if (!isArrayLike(given)) return meshFrom(given, "target");
  Mesh out = source;
  out.name = "target";
  out.vertices = pointsFrom(given, "V_target");
  if (out.vertices.size() != source.vertices.size())
    wrongValue("V_target", fmt::format("has {} rows, the source has {} vertices; a target with "
                                       "triangles of its own is V, F or a tuple (V, F)",
                                       out.vertices.size(), source.vertices.size()));
  return out;
}

void describeClose(Keywords& k, bool* close) {
  k.flag("close", close, "no longer needed: innermap caps the holes of an open mesh");
}

void bindMeshes(py::module_& m) {
  bindMeshClass(m);
  define<CallOptions>(
      m,
      {"read_mesh", "path",
       "Reads a mesh: .obj, .ply, .off or .stl, vertices in the order of the file, polygons cut "
       "into triangles. Returns an innermap.Mesh; V, F = read_mesh(path) has its arrays. Raises "
       "FileError."},
      [](const Arguments& a, CallOptions& o) {
        const std::string path = pathFrom(a[0], "path");
        return py::cast(std::make_shared<Mesh>(call(o, [&]() { return readMesh(path); })));
      });
  define<NoOptions>(m,
                    {"write_mesh", "path, *mesh",
                     "Writes a mesh to a .ply or .obj file. mesh: V, F or anything that stands for "
                     "a mesh. Raises FileError."},
                    [](const Arguments& a, NoOptions&) {
                      if (a.empty()) throw py::type_error("write_mesh() lacks its argument 'path'");
                      std::size_t at = 1;
                      const std::string path = pathFrom(a[0], "path");
                      const Mesh mesh = takeMesh(a, at, "mesh");
                      return withoutLock([&] { writeMesh(path, mesh); });
                    });
}

}  // namespace innermap::python
