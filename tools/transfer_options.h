// Options that say which grids are carried and how: what `pull`, `push` and `deform` share.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "command.h"
#include "innermap/transfer/pull.h"
#include "innermap/transfer/push.h"

namespace innermap::tool {

struct TransferOptions {
  std::string grids;  // names with commas between; empty: all
  std::string sampling = "linear";
  bool density = false;
  std::string densities, stress, strain;
  double outside = 0;
  std::string fadeTo = "cut";
  std::optional<int> resolution;
  std::optional<double> voxelSize;
  std::string names = "innermap";
};

void addTransferOptions(Command& command, TransferOptions& options);

CarrySettings carrySettings(const TransferOptions& options);

// from, to: boundary points before and after the motion, for --fade-to fitted. Throws UsageError
// for a motion that is none.
OutsideSettings outsideSettings(const TransferOptions& options, const Points& from,
                                const Points& to);

// Without sums' accuracy.
PushSettings pushSettings(const TransferOptions& options, const Points& from, const Points& to,
                          Context& context);

// The grids to be carried. Throws FileError for a name that is not there.
openvdb::GridPtrVec readVolume(const std::string& path, const TransferOptions& options,
                               Context& context);

// Peak need in bytes of pushing or pulling the grids to the solid's voxels.
std::uint64_t transferMemory(const Solid& solid, const openvdb::GridPtrVec& grids,
                             const TransferOptions& options);

// Throws MemoryError, with the highest --resolution that would fit, when the need is over the
// limit.
void requireTransferMemory(const Solid& solid, const openvdb::GridPtrVec& grids,
                           const TransferOptions& options, const Context& context);

// Level set of the output's solid: by --voxel-size or --resolution, else with the finest voxels of
// the grids.
openvdb::FloatGrid::Ptr outputLevelSet(const Solid& solid, const openvdb::GridPtrVec& grids,
                                       const TransferOptions& options, Context& context);

void writeVolume(const std::string& path, const openvdb::GridPtrVec& grids,
                 const TransferOptions& options, Context& context);

// Fills the report's "inverse" and "mass"; passes on the warnings.
void reportPush(const PushResult& result, Context& context);

// One line each for the terminal.
std::string pushText(const PushResult& result);

}  // namespace innermap::tool
