// Where a mesh was open: the boxes of the caps that repair() closed it with.
#pragma once

#include <cstddef>
#include <vector>

#include "innermap/core/vec3.h"
#include "innermap/mesh/repair.h"

namespace innermap {

// One box a cap, in the order of the caps; world units.
std::vector<Box3> capBoxes(const RepairedMesh& repaired);

// The same at other positions, of all vertices of repaired.mesh (repairedPositions()).
std::vector<Box3> capBoxes(const RepairedMesh& repaired, const Points& positions);

// The same where caps follow so many vertices and triangles of the mesh's own, as in
// SurfaceShells::mesh.
std::vector<Box3> capBoxes(const Points& vertices, const std::vector<Triangle>& triangles,
                           std::size_t ownVertices, std::size_t ownTriangles);

}  // namespace innermap
