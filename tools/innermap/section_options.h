// Where pictures of the inside cut, and in which colours.
#pragma once

#include <string>

#include "command.h"
#include "innermap/io/pictures.h"
#include "innermap/io/solid_pictures.h"
#include "innermap/levelset/solid.h"

namespace innermap::tool {

struct SectionOptions {
  Cut cut;
  Colormap colormap = Colormap::redBlue;
  SectionScale scale = SectionScale::automatic;

  // Of cells, where nothing else is said.
  int axis() const { return cut.axis.value_or(2); }
  double at() const { return cut.at.value_or(0.5); }
  // label: "spot.obj, cut" of path/spot.obj.
  CellPictureSettings cellPicture(const std::string& path) const;
  // Without an axis, where the solid is thinnest. density: fog of the solid's inside.
  SectionSettings of(const Solid& solid, const openvdb::FloatGrid& density) const;
};

// --section, --colormap and --scale, as `map` and `transfer-distance` have them.
void addSectionOptions(Command& command, SectionOptions& options);

// --section and --colormap of cells.
void addCut(Command& command, SectionOptions& options);

// --picture FILE and the cut's options, in a group of their own. help: what the picture shows.
void addCellPicture(Command& command, std::string& path, SectionOptions& cut,
                    const std::string& help);

}  // namespace innermap::tool
