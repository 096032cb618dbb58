// The files that commands read, timed as "read".
#pragma once

#include <openvdb/openvdb.h>

#include <string>
#include <vector>

#include "context.h"
#include "innermap/fit/mapped_solid.h"
#include "innermap/mesh/mesh.h"
#include "innermap/transfer/inverse_map.h"

namespace innermap::tool {

// Memory of a byte of a mesh's file, with the byte itself; measured: 1.3 to 2.4.
constexpr double kMeshByte = 2.6;

// Throws MemoryError when the mesh in a file would not fit.
void requireMeshMemory(const std::string& path, const Context& context);

// Throws as these, and as innermap::readMesh does.
// In output's space.
Mesh readMeshFile(const std::string& path, Context& context);

// What was read otherwise.
Mesh inOutput(const std::string& path, Mesh mesh, const Context& context);
// Carries points that are in input's space.
PointCarry fromInput(PointCarry carry, const Context& context);

// The grids of these names, or all, in output's space. Throws as innermap::readVdb and moveGrids
// do.
openvdb::GridPtrVec readGridFile(const std::string& path, const std::vector<std::string>& names,
                                 Context& context);

// A map; what is known of its boundaries is told and goes into the report.
MappedSolid readMapFile(const std::string& path, Context& context);

// The solid that the map's target bounds.
Solid targetSolid(const MappedSolid& mapped, Context& context);

}  // namespace innermap::tool
