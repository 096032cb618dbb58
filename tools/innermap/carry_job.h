// How long `push` and `pull` take.
#pragma once

#include <vector>

#include "job_clock.h"
#include "jobs/carry_job.h"

namespace innermap::tool {

std::vector<JobPhase> carryingPhases(const CarryJob& job);

}  // namespace innermap::tool
