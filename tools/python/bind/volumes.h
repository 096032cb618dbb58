// Grids out of arrays, files, meshes and maps; runs on several machines.
#pragma once

#include <pybind11/pybind11.h>

namespace innermap::python {

void bindVolumes(pybind11::module_& m);         // after bindGrids and bindMap
void bindVolumeTextures(pybind11::module_& m);  // likewise
void bindSolidTexture(pybind11::module_& m);
void bindStudy(pybind11::module_& m);
void bindJobs(pybind11::module_& m);

}  // namespace innermap::python
