// How near the boundary of a mesh of cells is to the surface of a solid.
#pragma once

#include <cstddef>
#include <cstdint>

#include "innermap/lattice/cell_mesh.h"
#include "innermap/levelset/solid.h"

namespace innermap {

// Fractions of the solid's diagonal.
struct SurfaceDistance {
  double rms = 0, max = 0;
};

struct BoundaryFit {
  SurfaceDistance toSurface;    // from samples of the mesh's boundary to the solid's surface
  SurfaceDistance fromSurface;  // and the other way
  std::size_t faces = 0;        // triangles of the boundary; a quadrilateral counts as two
  std::size_t inward = 0;  // that face against the surface at the point closest to their middle
};

struct BoundaryFitSettings {
  std::size_t samples = 20000;  // each way, at least 1
  std::uint64_t seed = 1;
};

// Distances are exact at the samples, which are uniform by area. The mesh must be valid. Throws
// DataError when the mesh has no boundary with an area, SettingError, Cancelled.
BoundaryFit boundaryFit(const CellMesh& mesh, const Solid& solid,
                        const BoundaryFitSettings& settings = {});

}  // namespace innermap
