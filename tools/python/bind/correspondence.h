// innermap.Correspondence: where the vertices of one mesh lie on another.
#pragma once

#include <pybind11/pybind11.h>

#include <memory>
#include <string>
#include <vector>

#include "bind/keywords.h"
#include "innermap/correspond/mesh_correspondence.h"

namespace innermap::python {

struct PyCorrespondence {
  Mesh source;                         // as given, or with its triangles split
  Points positions;                    // of its vertices, on the target
  std::vector<SurfacePoint> onTarget;  // triangle of the target; empty where a file has none
  bool changed = false;                // source is not as given
  std::vector<std::string> notes, warnings;
  pybind11::dict quality;  // empty where it was read from a file

  Mesh target(const std::string& name) const;  // source with its vertices there
};

// How one mesh is laid onto another: keywords of correspond() and, between strangers, of fit().
struct CorrespondOptions {
  MeshCorrespondenceSettings map;
  bool close = false;
  pybind11::object landmarks = pybind11::none();

  void describe(Keywords& k);
  // With the landmarks; with the interpreter's lock.
  MeshCorrespondenceSettings settings() const;
};

// a is laid onto b.
std::shared_ptr<PyCorrespondence> correspondMeshes(const Mesh& a, const Mesh& b,
                                                   const MeshCorrespondenceSettings& settings,
                                                   const CallOptions& call);

void bindCorrespondence(pybind11::module_& m);

}  // namespace innermap::python
