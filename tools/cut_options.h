// Where a picture of the inside cuts, and in which colours.
#pragma once

#include <string>
#include <vector>

#include "command.h"
#include "innermap/io/picture/cell_picture.h"
#include "innermap/io/picture/colormap.h"

namespace innermap::tool {

struct CutOptions {
  int axis = 2;
  double at = 0.5;  // of the box along the axis
  Colormap colormap = Colormap::redBlue;

  // label: "spot.obj, cut" of path/spot.obj.
  CellPictureSettings cellPicture(const std::string& path) const;
};

std::vector<Setting> describe(CutOptions& options);

// --picture FILE and the cut's options, in a group of their own. help: what the picture shows.
void addCellPicture(Command& command, std::string& path, CutOptions& cut, const std::string& help);

}  // namespace innermap::tool
