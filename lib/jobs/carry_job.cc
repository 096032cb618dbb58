#include "jobs/carry_job.h"

#include <algorithm>

namespace innermap {

LevelSetSettings carriedVoxels(const openvdb::GridPtrVec& grids, const LatticeChoice& choice,
                               double growth) {
  auto out = choice.in<LevelSetSettings>();
  if (!choice.voxelSize && !choice.resolution) out.voxelSize = growth * finestVoxel(grids);
  return out;
}

OutsideSettings outsideSettings(double distance, const FadeTo& fade, const MappedSolid& mapped) {
  OutsideSettings out = frameOutside(distance, fade).settings;
  if (fade.fitted)
    out.fadeTo =
        bestRigidMotion(mapped.solid().repaired().mesh.vertices, mapped.boundary.target.moved);
  return out;
}

FrameOutside frameOutside(double distance, const FadeTo& fade) {
  FrameOutside out;
  out.settings.distance = distance;
  out.settings.fadeTo = fade.motion;
  out.fitted = fade.fitted;
  return out;
}

PointCarry pointCarry(const SolidMap& map, const MappedSolid& mapped, bool push,
                      const OutsideSettings& outside) {
  CarryPointsSettings settings;
  settings.outside = outside;
  settings.accuracy = std::min(sumAccuracy(mapped), settings.accuracy);
  return carryByMap(map, mapped, push, settings);
}

CarryGeometrySettings carryGeometrySettings(const MappedSolid& mapped, bool push, double subdivide,
                                            SplatOpacity splats) {
  const double diagonal =
      push ? boundingBox(mapped.boundary.target.moved).diagonal() : mapped.solid().diagonal();
  return {subdivide * diagonal, splats, mapped.injectivity.mirrored};
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
