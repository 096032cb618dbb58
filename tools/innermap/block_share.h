// Shares of the blocks of a volume: what workers leave beside a file that is one in the end.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "innermap/evaluate/grids.h"
#include "share.h"

namespace innermap::tool {

// The folder of the parts of an output: "map.vdb.shares".
std::string sharesOf(const std::string& output);
// The output whose parts a folder has. Throws DataError for a folder of another name.
std::string outputOf(const std::string& shares);
// Where the voxels of a block go.
FramePattern blockPattern(const std::string& shares);

struct BlockWork {
  std::string output;              // of the whole
  std::string inputs;              // fingerprints of what is read
  std::vector<VoxelBlock> blocks;  // all of the run
  std::function<MapBlock(const openvdb::Coord&)> make;
};

// A worker's side: makes those blocks of its share that are not there yet.
void makeShare(const ShareOptions& options, const BlockWork& work, Context& context);

// The side of the command that `join` has conclude the run: all blocks. Throws FileError, DataError
// (other inputs than the parts', a file that is not as it was written).
std::vector<MapBlock> readShares(const std::string& output, const std::string& inputs,
                                 Context& context);

}  // namespace innermap::tool
