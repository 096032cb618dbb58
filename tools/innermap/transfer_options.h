// Options that say which grids are carried and how: what `pull`, `push` and `deform` share.
#pragma once

#include <string>

#include "grid_options.h"
#include "innermap/transfer/carry.h"
#include "innermap/transfer/push_pull.h"
#include "report/verdict.h"

namespace innermap::tool {

struct TransferOptions {
  std::string grids;  // names with commas between; empty: all
  CarrySettings carry;
  std::string densities, stress, strain;
  double outside = 0;
  std::string fadeTo = "cut";
  LatticeChoice grid;
  CarryVerdictSettings verdict;
  NamingScheme names = NamingScheme::innermap;
};

void addTransferOptions(Command& command, TransferOptions& options);

CarrySettings carrySettings(const TransferOptions& options);

// from, to: boundary points before and after the motion, for --fade-to fitted. Throws UsageError
// for a motion that is none.
OutsideSettings outsideSettings(const TransferOptions& options, const Points& from,
                                const Points& to);
// Where the motion of --fade-to fitted is each frame's own. Throws as above.
FrameOutside frameOutside(const TransferOptions& options);

// The grids to be carried. Throws FileError for a name that is not there.
openvdb::GridPtrVec readVolume(const std::string& path, const TransferOptions& options,
                               Context& context);

// Fills the report's "inverse", "mass" and "densities"; passes on the warnings.
void reportPush(const PushResult& result, Context& context);

// One line each for the terminal.
std::string pushText(const PushResult& result);
std::string inverseText(const InverseStatistics& inverse);

}  // namespace innermap::tool
