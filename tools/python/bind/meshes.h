// Meshes as arguments, in the ways that Python has them.
#pragma once

#include <pybind11/pybind11.h>

#include <string>

#include "bind/keywords.h"
#include "innermap/mesh/mesh.h"

namespace innermap::python {

void bindMeshes(pybind11::module_& m);
void bindCheck(pybind11::module_& m);
void bindSphere(pybind11::module_& m);

// `close=` of what is laid out, which nothing needs.
void describeClose(Keywords& k, bool* close);

// One of
//   V, F             two arguments, (n, 3) and (m, 3)
//   (V, F)           a tuple
//   "file.obj"       a path; the file is read by readMesh()
//   innermap.Mesh    what innermap.read_mesh() gave
//   mesh             with `points` and `cells` or `cells_dict` of triangles alone, as meshio.Mesh,
//                    or with `vertices` and `faces`, as trimesh.Trimesh
// name: of the mesh in messages ("source"); at: the argument that it begins with, moved behind it.
Mesh takeMesh(const Arguments& arguments, std::size_t& at, const std::string& name);
Mesh meshFrom(const pybind11::object& object, const std::string& name);
// Of a function that takes one mesh and nothing else.
Mesh onlyMesh(const Arguments& arguments, const std::string& function);
// The source with other places, V_target, or a mesh as one argument.
Mesh takeTarget(const Arguments& arguments, std::size_t& at, const Mesh& source);

bool isPath(pybind11::handle object);  // str or os.PathLike
std::string pathFrom(pybind11::handle object, const std::string& name);

}  // namespace innermap::python
