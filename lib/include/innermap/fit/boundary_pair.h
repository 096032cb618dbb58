// The two boundaries of a map: the source's solid, and where each of its points goes.
//
// Source and target have the same triangles. Caps of open loops, which repair adds to the source,
// move with it; see repairedPositions.
#pragma once

#include <string>
#include <vector>

#include "innermap/core/matrix.h"
#include "innermap/core/run.h"
#include "innermap/levelset/solid.h"
#include "innermap/mesh/check.h"
#include "innermap/mesh/mesh.h"

namespace innermap {

// A mesh and the solid that it bounds; serves any number of targets.
struct SourceBoundary {
  Mesh mesh;         // as it was given
  MeshReport check;  // of it
  Solid solid;
  std::vector<std::string> notes;     // what was repaired, a line each
  std::vector<std::string> warnings;  // what makes results doubtful
  StageSeconds seconds;               // "check", "solid"
};

// Throws DataError when the mesh has no inside, as Solid does, or crosses itself nearly everywhere;
// Cancelled.
SourceBoundary makeSourceBoundary(Mesh mesh);

// Where one target, a pose or a frame, takes the boundary of a source.
struct TargetBoundary {
  Points moved;         // positions of all vertices of source.repaired().mesh, world units
  double volume = 0;    // world units cubed; 0 when its parts cancel
  double diagonal = 0;  // world units
  std::vector<std::string> warnings;
  StageSeconds seconds;  // "solid"

  // Where points of source.surface() go: #points x 3.
  Matrix targetsOf(const Solid& source, const std::vector<SurfacePoint>& onSurface) const;
  // The target as a mesh that bounds a solid: the source's repaired triangles, moved.
  Mesh mesh(const Solid& source, const std::string& name) const;
};

// target: of the source's connectivity (#vertices alike, as readMeshLike sees to). Throws DataError
// when that is not so, when the target has no extent, or is flat; Cancelled.
TargetBoundary makeTargetBoundary(const Solid& source, const Mesh& target);

struct BoundaryPair {
  SourceBoundary source;
  Mesh targetMesh;         // as it was given
  MeshReport targetCheck;  // of it
  TargetBoundary target;
  std::vector<std::string> notes, warnings;  // of source, target and what they are together
  StageSeconds seconds;                      // "check", "solid"

  const Solid& solid() const { return source.solid; }
  Matrix targetsOf(const std::vector<SurfacePoint>& onSurface) const {
    return target.targetsOf(source.solid, onSurface);
  }
};

// Throws as the two above; DataError when the connectivity differs, or the target crosses itself
// nearly everywhere.
BoundaryPair makeBoundaryPair(Mesh source, Mesh target);

// The solid that the target bounds. Throws DataError when it has no inside; Cancelled.
Solid makeTargetSolid(const BoundaryPair& pair);

}  // namespace innermap
