// What `push` and `pull` carry, which way, and what that takes.
#pragma once

#include <vector>

#include "innermap/transfer/inverse_map.h"
#include "job_clock.h"
#include "transfer_options.h"

namespace innermap::tool {

enum class Way { push, pull };

// What both read.
struct CarryJob {
  MappedSolid mapped;
  Solid target;
  OutsideSettings outside;
  openvdb::GridPtrVec grids;
  SolidMap map;
};

// What voxels grow by, unless told otherwise.
double growthOf(Way way, const CarryJob& job);

std::vector<JobPhase> carryingPhases(Way way, const CarryJob& job, const TransferOptions& options,
                                     double growth);

}  // namespace innermap::tool
