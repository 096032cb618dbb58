#include "jobs/carry_job.h"

namespace innermap {

LevelSetSettings carriedVoxels(const openvdb::GridPtrVec& grids, const LatticeChoice& choice,
                               double growth) {
  auto out = choice.in<LevelSetSettings>();
  if (!choice.voxelSize && !choice.resolution) out.voxelSize = growth * finestVoxel(grids);
  return out;
}

OutsideSettings outsideSettings(double distance, const FadeTo& fade, const Points& from,
                                const Points& to) {
  OutsideSettings out;
  out.distance = distance;
  out.fadeTo = fade.fitted ? bestRigidMotion(from, to) : fade.motion;
  return out;
}

FrameOutside frameOutside(double distance, const FadeTo& fade) {
  return {outsideSettings(distance, {fade.motion}, {}, {}), fade.fitted};
}

MemoryNeed CarryJob::need() const {
  return gridNeed("carrying the grids", lattice, [this](const LatticeChoice& choice) {
    return carryMemory(to(), grids, carriedVoxels(grids, choice, growth()), outside, carry,
                       {push, 0});
  });
}

PushSettings pushSettings(const CarryJob& job) {
  PushSettings out;
  out.carry = job.carry;
  out.outside = job.outside;
  out.accuracy = sumAccuracy(*job.mapped);
  return out;
}

VolumePusher pusherOf(const CarryJob& job) {
  return {job.mapped->solid(), job.grids, pushSettings(job)};
}

Puller pullerOf(const CarryJob& job) {
  PullSettings settings;
  settings.carry = job.carry;
  settings.outside = job.outside;
  settings.accuracy = sumAccuracy(*job.mapped);
  const openvdb::FloatGrid::Ptr target = makeLevelSet(job.target, carriedVoxels(job.grids, {}));
  settings.targetLevelSet = target.get();
  return {target, VolumePuller(job.map, job.mapped->solid(), job.grids, settings)};
}

}  // namespace innermap
