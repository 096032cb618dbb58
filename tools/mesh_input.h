// Meshes that commands read, and what their reports say of them.
#pragma once

#include <string>

#include "context.h"
#include "innermap/mesh/mesh.h"

namespace innermap::tool {

// Timed as "read". Throws as innermap::readMesh does.
Mesh readMeshFile(const std::string& path, Context& context);

}  // namespace innermap::tool
