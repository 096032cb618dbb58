// A solid's boundary as one clean closed surface, whatever the mesh was.
#pragma once

#include <cstdint>

#include "innermap/core/progress.h"
#include "innermap/levelset/solid.h"
#include "innermap/mesh/mesh.h"

namespace innermap {

struct IsosurfaceSettings {
  int resolution = 128;      // voxels along the longest side of the solid's box, in [8, 2048]
  double leastShell = 1e-3;  // shells of less volume than this share of the largest one's are left
                             // out, in [0, 1)
  std::uint64_t maxMemory = 0;  // bytes; 0 means no limit
  Progress* progress = nullptr;
};

struct Isosurface {
  Mesh mesh;                // world units, closed and manifold, outward
  double voxelSize = 0;     // world units; the surface is about this near to the solid's
  std::size_t shells = 0;   // of the mesh
  std::size_t leftOut = 0;  // shells too small
};

// The zero set of makeLevelSet(): holes are closed, overlapping parts united, parts thinner than
// about a voxel may be lost. Marching cubes (Lorensen, Cline 1987) with each ambiguous face decided
// by its own four values alone (Nielson, Hamann, "The asymptotic decider", 1991), so that every
// edge has two triangles; then vertices are evened out along the surface. Deterministic. Throws
// what makeLevelSet throws; DataError when nothing is left.
Isosurface isosurfaceOf(const Solid& solid, const IsosurfaceSettings& settings = {});

}  // namespace innermap
