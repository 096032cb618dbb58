// What is known of a field on a surface, as Python gives it.
#pragma once

#include <pybind11/pybind11.h>

#include <string>
#include <vector>

#include "bind/keywords.h"
#include "innermap/fit/fit_harmonic.h"
#include "innermap/mesh/mesh.h"

namespace innermap::python {

// Groups of triangles by name: of a dict {name: triangles}, and of the OBJ file that a mesh was
// read from.
class Groups {
 public:
  // given: None or the dict.
  Groups(const Mesh& mesh, const pybind11::object& given);

  // A name, whole numbers (counted from 0) or a mask of the mesh's triangles.
  SurfaceGroup select(const pybind11::object& given, const std::string& name) const;
  // Those given, or else all of the file that have faces; with names only those, in their order.
  std::vector<SurfaceGroup> all(const pybind11::object& names) const;

 private:
  const Mesh& mesh_;
  mutable std::vector<SurfaceGroup> groups_;
  mutable bool read_ = false;

  const std::vector<SurfaceGroup>& known() const;
};

// Arguments of harmonic().
struct GivenConditions {
  pybind11::object values = pybind11::none(), fix = pybind11::none(), flux = pybind11::none(),
                   groups = pybind11::none();
};

class ConditionsFrom {
 public:
  ConditionsFrom(const Mesh& mesh, const GivenConditions& given);

  BoundaryConditions& conditions() { return conditions_; }

 private:
  void fixGroups();
  void takeValues();
  void takeFluxes();
  void keepOnly(const SurfaceGroup& held);

  const Mesh& mesh_;
  const GivenConditions& given_;
  Groups groups_;
  BoundaryConditions conditions_;
};

}  // namespace innermap::python
