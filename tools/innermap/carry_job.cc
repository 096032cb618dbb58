#include "carry_job.h"

#include "job_cost.h"

namespace innermap::tool {

double growthOf(Way way, const CarryJob& job) {
  const double from = job.mapped.solid().volume(), to = job.target.volume();
  return way == Way::push ? voxelGrowth(from, to) : voxelGrowth(to, from);
}

std::vector<JobPhase> carryingPhases(Way way, const CarryJob& job, const TransferOptions& options,
                                     double growth) {
  const std::size_t charges = job.mapped.map.sources();
  const double asGiven = finestVoxel(job.grids);
  const auto sizeOf = [&](const Solid& solid, const LevelSetSettings& settings) {
    return jobSize(solid, settings, charges);
  };
  LevelSetSettings given;
  given.voxelSize = asGiven;
  const Solid& source = job.mapped.solid();
  const Solid& to = way == Way::push ? job.target : source;
  JobSize made = sizeOf(to, outputSettings(job.grids, options.grid, growth));
  made.items = static_cast<double>(job.grids.size()) * made.inside;
  const JobSize from = sizeOf(way == Way::push ? source : job.target, given);
  JobPhase levelSets = stageOf("level set", made);
  levelSets += stageOf("level set", from);
  levelSets.times = 2;
  std::vector<JobPhase> phases = {levelSets};
  const CarrySettings carry = carrySettings(options);
  std::size_t densities = 0;
  for (const openvdb::GridBase::Ptr& grid : job.grids) densities += isDensity(*grid, carry);
  if (way == Way::pull) {
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
