// Options that say which grids are carried and how: what `pull`, `push` and `deform` share.
#pragma once

#include <string>

#include "grid_options.h"
#include "innermap/transfer/carry.h"
#include "innermap/transfer/push_pull.h"
#include "jobs/carry_job.h"
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

// What --fade-to says. Throws UsageError for a motion that is none.
FadeTo fadeTo(const TransferOptions& options);

// The grids to be carried. Throws FileError for a name that is not there.
openvdb::GridPtrVec readVolume(const std::string& path, const TransferOptions& options,
                               Context& context);

// Fills the report's "inverse", "mass" and "densities"; passes on the warnings.
void reportPush(const PushResult& result, Context& context);

// One line each for the terminal.
std::string pushText(const PushResult& result);
std::string inverseText(const InverseStatistics& inverse);

}  // namespace innermap::tool
