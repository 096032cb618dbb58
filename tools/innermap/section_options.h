// Where the pictures that `map` and `transfer-distance` draw cut the solid.
#pragma once

#include <openvdb/openvdb.h>

#include "command.h"
#include "innermap/io/pictures.h"
#include "innermap/levelset/solid.h"

namespace innermap::tool {

struct SectionOptions {
  Cut cut;  // without an axis: where the solid is thinnest
  Colormap colormap = Colormap::redBlue;
  SectionScale scale = SectionScale::automatic;
};

void addSectionOptions(Command& command, SectionOptions& options);

// density: fog of the solid's inside.
SectionSettings sectionSettings(const SectionOptions& options, const Solid& solid,
                                const openvdb::FloatGrid& density);

}  // namespace innermap::tool
