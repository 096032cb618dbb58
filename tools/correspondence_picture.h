// A's coordinates as colours, on A and on B side by side.
#pragma once

#include <string>

#include "context.h"
#include "innermap/boundary/mesh_correspondence.h"

namespace innermap::tool {

// B is coloured point by point by where the map comes from, not vertex by vertex. Throws FileError.
void writeCorrespondencePicture(const std::string& path, const MeshCorrespondence& map,
                                Context& context);

}  // namespace innermap::tool
