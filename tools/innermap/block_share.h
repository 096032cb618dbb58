// Shares of the blocks of a volume: what workers leave beside a file that is one in the end.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "grid_options.h"
#include "innermap/evaluate/grids.h"
#include "share.h"

namespace innermap::tool {

// The folder of the parts of an output: "map.vdb.shares".
std::string sharesOf(const std::string& output);
// The output whose parts a folder has. Throws DataError for a folder of another name.
std::string outputOf(const std::string& shares);
bool isShares(const std::string& folder);  // by its name
// Where the voxels of a block go.
FramePattern blockPattern(const std::string& shares);

// What workers left there, less those whose file is not there or not whole: these are missing, but
// for broken ones if `broken`.
JoinedParts partsWithFiles(JoinedParts joined, const FramePattern& pattern, bool broken);
// "FOLDER: 2 of 4 blocks are missing: 3, 4"
std::string missingText(const std::string& folder, const JoinedParts& joined);
// The files of all blocks of a volume whose grids are those of the output, ascending. Throws
// FileError, DataError.
std::vector<std::string> blockFiles(const std::string& shares);

// As addShareOptions().
void addBlockOptions(Command& command, ShareOptions& options);

// Before anything is read: looks at the options, and tells of the output unless it is made in
// shares. Throws UsageError, SettingError, FileError.
void beginBlocks(const ShareOptions& options, const std::string& output, Context& context);

// A run that makes one volume.
struct BlockWork {
  std::string output;                               // of the whole
  std::string inputs;                               // fingerprints of what is read
  std::string doing;                                // "evaluate map.ply"
  std::string stage;                                // of the report's seconds
  std::function<std::vector<VoxelBlock>()> blocks;  // all of the run
  std::function<GridBlock(const VoxelBlock&)> make;
  std::uint64_t memory = 0, joinMemory = 0;  // of a block; of the join; bytes
  std::vector<JobPhase> making, joining;     // of all blocks; of the join
};

// That of a map's grids, but for output, inputs, doing and make. solid: must outlive it.
BlockWork evaluationWork(const Solid& solid, const EvaluationOptions& options, std::size_t charges,
                         const MapGridKind& kind);

// The jobs that make it.
ShareRun shareRun(const BlockWork& work);

// With --share makes those blocks of the share that are not there yet, with --jobs writes the jobs,
// and returns true; false where the run is to make all by itself. Throws as these do.
bool madeInShares(const ShareOptions& options, const BlockWork& work, Context& context);

// The side of the command that `join` has conclude the run: all blocks. Throws FileError, DataError
// (other inputs than the parts', a file that is not as it was written).
std::vector<GridBlock> readShares(const std::string& output, const std::string& inputs,
                                  Context& context);

}  // namespace innermap::tool
