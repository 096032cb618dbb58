// The grids that a transfer makes, leaf by leaf.
#pragma once

#include <openvdb/openvdb.h>

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "evaluate/grid_blocks.h"
#include "innermap/transfer/carry.h"
#include "transfer/detail/carrier.h"

namespace innermap {

using Carriers = std::vector<std::unique_ptr<Carrier>>;

class CarryOutput {
 public:
  // levelSet: of the solid that the output lives in; the region is on its lattice.
  CarryOutput(const Carriers& carriers, const openvdb::MaskGrid& region,
              const openvdb::FloatGrid& levelSet);

  // For the active voxels of the region's leaf at `origin`, in order. From any thread.
  void carry(const openvdb::Coord& origin, const Site* sites) const;

  // Their voxels as GridBlock has them, and taken from all blocks.
  openvdb::GridPtrVec blockGrids() const;
  void take(GridBlocks& blocks) const;

  // Each at its place in `grids`. movePositions: of values that are positions.
  void finish(const std::function<Points(const Points&)>& movePositions,
              openvdb::GridPtrVec& grids);

 private:
  const Carriers& carriers_;
  const openvdb::FloatGrid& levelSet_;
  std::vector<openvdb::GridPtrVec> outputs_;
};

// Throws DataError when no grid has an active voxel within `skin` voxels of the solid; warns of
// single ones that have none.
void requireMeeting(const openvdb::GridPtrVec& grids, const openvdb::FloatGrid& solid,
                    const std::string& solidName, std::vector<std::string>& warnings);

// Says in the grids' metadata what lies outside the solid.
void noteOutside(const openvdb::GridPtrVec& grids, const OutsideSettings& outside);

// Bytes that a voxel of the outputs takes.
std::uint64_t outputBytesPerVoxel(const openvdb::GridPtrVec& grids);

}  // namespace innermap
