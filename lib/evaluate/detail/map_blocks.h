// The blocks of a volume, joined to one again.
#pragma once

#include <openvdb/openvdb.h>

#include <vector>

#include "evaluate/detail/map_values.h"
#include "innermap/evaluate/grids.h"

namespace innermap {

// As GridBlock has them.
std::vector<double> totalsOf(const BlockTotals& totals);

// Takes the voxels of the blocks. transform: of the whole; surface becomes its level set. Throws
// DataError where the blocks are no such.
MapValues mergeBlocks(std::vector<GridBlock> blocks, const openvdb::math::Transform::Ptr& transform,
                      openvdb::FloatGrid::Ptr& surface);

}  // namespace innermap
