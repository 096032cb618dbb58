#include <pybind11/pybind11.h>

#include "bind/call.h"
#include "bind/carry_options.h"
#include "bind/cells.h"
#include "bind/correspondence.h"
#include "bind/deformer.h"
#include "bind/errors.h"
#include "bind/field.h"
#include "bind/figures.h"
#include "bind/frame_set.h"
#include "bind/grids.h"
#include "bind/map.h"
#include "bind/meshes.h"
#include "bind/volumes.h"
#include "innermap/core/version.h"

namespace py = pybind11;
using namespace innermap::python;

namespace {

py::list publicNames(const py::module_& m) {
  py::list names;
  for (const auto& item : py::dict(m.attr("__dict__"))) {
    const auto name = py::cast<std::string>(item.first);
    if (name[0] != '_' && name != "MemoryError") names.append(name);
  }
  return names;
}

}  // namespace

PYBIND11_MODULE(_innermap, m) {
  // Docstrings begin with signatures of their own; see documented().
  py::options options;
  options.disable_function_signatures();
  bindErrors(m);
  bindCalls();
  bindMeshes(m);
  bindCheck(m);
  bindFigures(m);
  bindGrids(m);
  bindMap(m);
  bindMapGrids(m);
  bindCorrespondence(m);
  bindSphere(m);
  bindFit(m);
  bindField(m);
  bindHarmonic(m);
  bindLoad(m);
  bindCells(m);
#if INNERMAP_TETRA
  bindCellChecks(m);
  bindFill(m);
  bindRemesh(m);
  bindCompareFem(m);
#endif
  bindCarry(m);
  bindDeformer(m);
  bindDeform(m);
  bindSequence(m);
  bindVolumes(m);
  bindVolumeTextures(m);
  bindSolidTexture(m);
#if INNERMAP_STUDY
  bindStudy(m);
#endif
  bindJobs(m);
  for (const auto& item : py::dict(m.attr("__dict__")))
    if (py::hasattr(item.second, "__module__") && py::cast<std::string>(item.first)[0] != '_')
      py::setattr(item.second, "__module__", py::str("innermap"));
  m.attr("__version__") = innermap::versionText();
  m.attr("__all__") = publicNames(m);
}
