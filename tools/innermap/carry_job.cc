#include "carry_job.h"

#include "job_cost.h"

namespace innermap::tool {

std::vector<JobPhase> carryingPhases(const CarryJob& job) {
  const std::size_t charges = job.mapped->map.sources();
  const auto sizeOf = [&](const Solid& solid, const LevelSetSettings& settings) {
    return jobSize(solid, settings, charges);
  };
  JobSize made = sizeOf(job.to(), job.output());
  made.items = static_cast<double>(job.grids.size()) * made.inside;
  const JobSize from = sizeOf(job.from(), carriedVoxels(job.grids, {}));
  JobPhase levelSets = stageOf("level set", made);
  levelSets += stageOf("level set", from);
  levelSets.times = 2;
  std::vector<JobPhase> phases = {levelSets};
  std::size_t densities = 0;
  for (const openvdb::GridBase::Ptr& grid : job.grids) densities += isDensity(*grid, job.carry);
  if (!job.push) {
    phases.push_back(stageOf("pulling the grids", made));
  } else {
    if (densities < job.grids.size()) {
      phases.push_back(stageOf("covering the target", made));
      phases.push_back(stageOf("inverting the map", made));
      phases.push_back(stageOf("carrying the grids", made));
    }
    if (densities > 0) {
      JobSize held = from;
      held.items = static_cast<double>(densities) * from.inside;
      phases.push_back(stageOf("finding the inside", held));
      phases.push_back(stageOf("carrying the densities", held));
    }
  }
  phases.push_back(stageOf("writing the VDB file", made));
  return phases;
}

}  // namespace innermap::tool
