// A correspondence asked anywhere.
#pragma once

#include <vector>

#include "innermap/core/progress.h"
#include "innermap/surface/closed_surface.h"
#include "innermap/surface/correspond.h"

namespace innermap {

struct SurfaceImages {
  Points positions;                    // #points, world units, on B
  std::vector<SurfacePoint> onTarget;  // #points: triangle of target.mesh
  double farthest = 0;                 // of the points from A's surface, world units
};

// Where points near A's surface lie on B: each goes where the closest point of A's shells goes, by
// the map through the model space, which is one-to-one (not by chords between moved vertices).
// `target`: the shells that the map was made onto (b.surfaces()). Same result for any number of
// threads. Throws Cancelled.
SurfaceImages imagesOf(const Points& points, const Correspondence& map, const SurfaceShells& target,
                       Progress* progress = nullptr);

// The way back: the points of A (world units) that lie on points of B, given by triangle of
// target.mesh. Points of triangles that are in no shell go with the closest shell. Throws
// Cancelled.
Points preimagesOf(const std::vector<SurfacePoint>& onTarget, const Correspondence& map,
                   const SurfaceShells& target, Progress* progress = nullptr);

}  // namespace innermap
