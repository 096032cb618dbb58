// What `polycube` and `hexahedralize` have in common: their input, reports and pictures.
#pragma once

#include <string>

#include "command.h"
#include "correspondence.h"
#include "innermap/tetra/hexahedralize.h"

namespace innermap::tool {

// MESH, --blocks and the options of its outer surface.
void addFillOptions(Command& c, std::string& mesh, PolycubeSettings& polycube,
                    SurfaceOptions& surface);

// "polycube"; a line, and one for each part that is missed.
void reportPolycube(const Polycube& cube, Context& context);

void drawPolycube(const std::string& path, const Mesh& mesh, const BlockSet& blocks);

}  // namespace innermap::tool
