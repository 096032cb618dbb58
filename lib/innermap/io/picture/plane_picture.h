// Functions on a plane through a solid, side by side.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "innermap/core/vec3.h"
#include "innermap/io/picture/colormap.h"

namespace innermap {

struct PlaneFunction {
  std::string label;  // above it
  // Values at points of the plane; one that is not finite is left blank.
  std::function<std::vector<double>(const Points&)> values;
};

struct PlanePictureSettings {
  int axis = 2;              // the plane is across it: 0, 1, 2
  double at = 0.5;           // fraction of the box along the axis, in [0, 1]
  double blue = 0, red = 1;  // the values of the ends of the colours; different
  Colormap colormap = Colormap::redBlue;
  std::string caption;  // below all
  int pixels = 480;     // each view's height, in [64, 4096]
};

// Writes a PNG; the file appears whole or not at all. Throws DataError when there is no function or
// no box, SettingError, FileError, Cancelled.
void writePlanePicture(const std::string& path, const Box3& box,
                       const std::vector<PlaneFunction>& functions,
                       const PlanePictureSettings& settings = {});

}  // namespace innermap
