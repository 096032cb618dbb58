// The two boundaries of a map: the source's solid, and where each of its points goes.
#pragma once

#include <string>
#include <vector>

#include "context.h"
#include "innermap/core/matrix.h"
#include "innermap/levelset/solid.h"
#include "innermap/mesh/mesh.h"

namespace innermap::tool {

struct BoundaryPair {
  Mesh source, target;        // as read, same connectivity
  Solid solid;                // of the source
  Points moved;               // target positions of all vertices of solid.repaired().mesh
  double targetVolume = 0;    // world units cubed; 0 when its parts cancel
  double targetDiagonal = 0;  // world units

  // Where points of solid.surface() go: #points x 3.
  Matrix targetsOf(const std::vector<SurfacePoint>& onSurface) const;
};

// Reads, checks and repairs both meshes; notes and warnings go to the context, what is known of the
// meshes into its report. Throws what readMesh, readMeshLike and Solid throw.
BoundaryPair readBoundaryPair(const std::string& source, const std::string& target,
                              Context& context);

// The same for meshes in memory.
BoundaryPair makeBoundaryPair(Mesh source, Mesh target, Context& context);

}  // namespace innermap::tool
