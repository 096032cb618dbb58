// The cells of a proof as marks on the voxels of a solid.
#pragma once

#include <openvdb/openvdb.h>

#include <vector>

#include "innermap/proof/prove.h"

namespace innermap {

// `marks`, or a grid of that name, made 1 and active at the voxels inside whose centre lies in one
// of the cells; null where that is nowhere. levelSet: of the solid that was proven. Throws
// Cancelled.
openvdb::FloatGrid::Ptr markCells(const std::vector<ProofCell>& cells,
                                  const openvdb::FloatGrid& levelSet, const char* name,
                                  openvdb::FloatGrid::Ptr marks = nullptr);

}  // namespace innermap
