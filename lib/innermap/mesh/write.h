// Mesh files out.
#pragma once

#include <string>

#include "innermap/mesh/mesh.h"

namespace innermap {

// Writes .ply (binary little endian, double) or .obj (digits that read back to the same number) by
// the extension: vertices, triangles, vertex colours (in .ply 8 bits each); OBJ also texture
// coordinates. The file appears whole or not at all. Throws FileError.
void writeMesh(const std::string& path, const Mesh& mesh);

}  // namespace innermap
