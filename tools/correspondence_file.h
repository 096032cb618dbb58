// The file of a correspondence: a mesh moved onto another, with the addresses of its vertices.
#pragma once

#include <string>
#include <vector>

#include "innermap/mesh/mesh.h"

namespace innermap::tool {

// PLY, binary little endian: vertices x y z (double), `triangle` (int, of the other mesh, counted
// from 0) and `b0 b1 b2` (double, barycentric coordinates there); the mesh's triangles. The file
// appears whole or not at all. Throws FileError.
void writeCorrespondence(const std::string& path, const Mesh& moved,
                         const std::vector<SurfacePoint>& onTarget);

}  // namespace innermap::tool
