// Solids filled with well-shaped tetrahedra.
#pragma once

#include <cstdint>
#include <optional>

#include "innermap/core/progress.h"
#include "innermap/levelset/solid.h"
#include "innermap/tetra/cell_mesh.h"

namespace innermap {

struct TetrahedralizeSettings {
  int resolution = 64;  // cells of the lattice along the longest side of the box, in [4, 1024]
  double edge = 0;      // a cell's side, world units; 0 means: resolution decides
  std::uint64_t maxMemory = 0;  // bytes; 0 means no limit
  Progress* progress = nullptr;
};

// Isosurface stuffing (Labelle and Shewchuk, SIGGRAPH 2007) on a uniform body-centred cubic
// lattice: all dihedral angles lie in 10 to 165 degrees, every tetrahedron has a vertex inside. The
// boundary's vertices are moved to the closest points of the solid's surface as far as the angles
// allow. Deterministic. Throws SettingError, MemoryError (before allocating), Cancelled, DataError
// when the lattice is so coarse that nothing is inside.
CellMesh tetrahedralize(const Solid& solid, const TetrahedralizeSettings& settings = {});

}  // namespace innermap
