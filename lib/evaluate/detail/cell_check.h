// Whether the map that is linear on the cells between voxels is one-to-one.
#pragma once

#include <openvdb/openvdb.h>

#include "fit/target_shape.h"
#include "innermap/fit/mapped_solid.h"

namespace innermap {

// map: target positions of voxels less `origin`, world units; levelSet: of the solid, with the same
// transform. Determinants of all cells; where none is folded, and their boundary has no more than
// half a million triangles, also the overlaps of its image. There each cell is taken to one that is
// not turned over, so as many cells lie about a point as that image winds about it (see
// injectivity.h): an image that does not run through itself, and winds once about what lies just
// inside each of its parts, bounds cells that do not overlap. Double precision. Throws Cancelled.
CellFigures checkCells(const openvdb::Vec3fGrid& map, const openvdb::FloatGrid& levelSet,
                       const TargetShape& target, double error, const Vec3& origin = {});

}  // namespace innermap
