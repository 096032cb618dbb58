// Whether the map that is linear on the cells between voxels is one-to-one.
#pragma once

#include <openvdb/openvdb.h>

#include "fit/target_shape.h"
#include "innermap/fit/mapped_solid.h"

namespace innermap {

// map: target positions of voxels less `origin`, world units; levelSet: of the solid, with the same
// transform. Determinants of all cells, by the exact signs of the grid's floats, as they are
// written (core/orientation.h); where none is folded, and their boundary has no more than half a
// million triangles, also the overlaps of its image, by exact signs too (mesh/cover_once.h). Throws
// Cancelled.
CellFigures checkCells(const openvdb::Vec3fGrid& map, const openvdb::FloatGrid& levelSet,
                       const TargetShape& target, double error, const Vec3& origin = {});

}  // namespace innermap
