// Where a picture of the inside cuts, and in which colours.
#pragma once

#include <string>

#include "command.h"
#include "innermap/io/pictures.h"
#include "innermap/io/solid_pictures.h"

namespace innermap::tool {

struct CutOptions {
  Cut cut;

  int axis() const { return cut.axis.value_or(2); }
  double at() const { return cut.at.value_or(0.5); }
  Colormap colormap = Colormap::redBlue;

  // label: "spot.obj, cut" of path/spot.obj.
  CellPictureSettings cellPicture(const std::string& path) const;
};

// --section and --colormap.
void addCut(Command& command, CutOptions& options);

// --picture FILE and the cut's options, in a group of their own. help: what the picture shows.
void addCellPicture(Command& command, std::string& path, CutOptions& cut, const std::string& help);

}  // namespace innermap::tool
