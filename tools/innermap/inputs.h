// The files that commands read, timed as "read".
#pragma once

#include <openvdb/openvdb.h>

#include <string>
#include <vector>

#include "context.h"
#include "innermap/fit/mapped_solid.h"
#include "innermap/mesh/mesh.h"

namespace innermap::tool {

// Memory of a byte of a mesh's file, with the byte itself; measured: 1.3 to 2.4.
constexpr double kMeshByte = 2.6;

// Throws MemoryError when the mesh in a file would not fit.
void requireMeshMemory(const std::string& path, const Context& context);

// Throws as these, and as innermap::readMesh does.
Mesh readMeshFile(const std::string& path, Context& context);

// The grids of these names, or all. Throws as innermap::readVdb does.
openvdb::GridPtrVec readGridFile(const std::string& path, const std::vector<std::string>& names,
                                 Context& context);

// A map; what is known of its boundaries is told and goes into the report.
MappedSolid readMapFile(const std::string& path, Context& context);

// The solid that the map's target bounds.
Solid targetSolid(const MappedSolid& mapped, Context& context);

}  // namespace innermap::tool
