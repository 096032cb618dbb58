// What `polycube` and `hexahedralize` have in common: their input, reports and pictures.
#pragma once

#include <string>

#include "command.h"
#include "innermap/tetra/polycube.h"

namespace innermap::tool {

// MESH, --blocks, --close, --surface-resolution.
void addFillOptions(Command& c, std::string& mesh, int& blocks, bool& closeHoles, int& resolution);

// The mesh, or with a resolution above 0 the isosurface of its solid.
Mesh surfaceToFill(const std::string& path, int resolution, Context& context);

// Throws UsageError unless the path ends in .obj or .ply.
void requireMeshFile(const std::string& option, const std::string& path);

// "polycube"; a line, and one for each part that is missed.
void reportPolycube(const Polycube& cube, Context& context);

void drawPolycube(const std::string& path, const Mesh& mesh, const BlockSet& blocks,
                  Context& context);

}  // namespace innermap::tool
