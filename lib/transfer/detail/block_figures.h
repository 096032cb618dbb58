// What pushing and pulling tell of their voxels, summed block by block: so it does not depend on
// who made which block of a volume.
#pragma once

#include <openvdb/openvdb.h>

#include <vector>

#include "evaluate/grid_blocks.h"
#include "innermap/transfer/carry.h"
#include "innermap/transfer/inverse_map.h"

namespace innermap {

// Of some voxels, or all.
struct CarryFigures {
  InverseStatistics inverse;  // of what is pulled the number of voxels alone
  ResamplingFigures resampling;

  void add(const CarryFigures& others);
};

// Edges of voxels and no sums.
ResamplingFigures voxelsOf(const openvdb::GridPtrVec& input, double outputVoxel);

struct BlockFigures {
  openvdb::Coord block;
  CarryFigures figures;
};

// Of the block, which is the last or one more.
CarryFigures& figuresAt(const openvdb::Coord& block, std::vector<BlockFigures>& blocks);

// Throws SettingError for what is around the solid: blocks have what is in it.
void requireNoOutside(const OutsideSettings& outside);

// As files have them.
constexpr std::size_t kCarryNumbers = 65;
BlockSums sumsOf(const BlockFigures& figures);
CarryFigures figuresOf(const std::vector<double>& numbers);  // kCarryNumbers
// Of all blocks.
CarryFigures sumOf(const GridBlocks& blocks, const ResamplingFigures& voxels);

}  // namespace innermap
