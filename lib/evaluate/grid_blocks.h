// The blocks of a volume: what of a solid is in each, and their grids merged to those of the whole.
#pragma once

#include <openvdb/openvdb.h>

#include <string>
#include <vector>

#include "innermap/evaluate/grids.h"

namespace innermap {

// GridBlock::totals.
struct BlockSums {
  openvdb::Coord block;  // its origin
  std::vector<double> numbers;
};
std::vector<double> totalsOf(const BlockSums& sums);

class GridBlocks {
 public:
  // transform: of the whole. numbers: so many does each block have. Throws DataError, naming the
  // block, for other totals and for a block that is there twice.
  GridBlocks(std::vector<GridBlock> blocks, openvdb::math::Transform::Ptr transform,
             std::size_t numbers);

  // Of all blocks, ascending by origin.
  const std::vector<BlockSums>& sums() const { return sums_; }

  // Takes the voxels of the blocks' grids of this name, which must have the type of `whole`, one of
  // GridTypes. Throws DataError, naming the block, where there is no such grid, or it has voxels in
  // another block.
  void mergeInto(openvdb::GridBase& whole, const std::string& name);
  // The same of "surface": level sets of blocks to that of the whole.
  openvdb::FloatGrid::Ptr levelSet();

  // Names of the grids that the first block has.
  std::vector<std::string> names() const;

 private:
  [[noreturn]] static void refuse(const GridBlock& block, const std::string& name);
  template <class Grid>
  typename Grid::Ptr gridOf(std::size_t block, const std::string& name) const;

  std::vector<GridBlock> blocks_;
  std::vector<BlockSums> sums_;
  openvdb::math::Transform::Ptr transform_;
};

}  // namespace innermap
