// How the values of dense files stand in them, as the machine has them: little-endian.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "innermap/io/volume_texture.h"
#include "io/volume/detail/volume_plan.h"

namespace innermap {

struct DenseType {
  const char* vtk;     // the name that VTK's XML files have for it
  std::int16_t nifti;  // NIfTI's code, DT_...
  std::size_t bytes;
  void (*put)(double value, char* to);
};

// By the type of a grid, or of a vector's components: "float", "vec3s", "int32", ...
const DenseType& denseType(const std::string& gridType);

// Of the settings, the exact plan of files that have x fastest, then y, then z.
VolumePlan makeDensePlan(const openvdb::GridPtrVec& grids, const VolumeTextureSettings& settings);

// Without counts; the channels are the grids' names.
VolumeTextureResult denseResult(const std::string& path, const VolumePlan& plan);

}  // namespace innermap
