// The two boundaries of a map: the source's solid, and where each of its points goes.
#pragma once

#include <string>
#include <vector>

#include "context.h"
#include "innermap/core/matrix.h"
#include "innermap/levelset/solid.h"
#include "innermap/mesh/mesh.h"

namespace innermap::tool {

// Where one target, a pose or a frame, takes the boundary of a source.
struct TargetBoundary {
  Points moved;         // positions of all vertices of solid.repaired().mesh
  double volume = 0;    // world units cubed; 0 when its parts cancel
  double diagonal = 0;  // world units
};

// The source alone, checked and repaired; its notes, warnings and figures go to the context. Serves
// any number of targets. Throws what Solid throws.
Solid makeSourceSolid(const Mesh& source, Context& context);

// target: of the source's connectivity. Throws DataError when it has no extent or is flat.
TargetBoundary makeTargetBoundary(const Solid& source, const Mesh& target, Context& context);

// The target as a mesh that bounds a solid: the source's repaired triangles, moved.
Mesh movedMesh(const Solid& source, const TargetBoundary& target, const std::string& name);

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
