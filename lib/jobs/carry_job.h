// The job of push and pull: grids carried through a map, or back.
#pragma once

#include <openvdb/openvdb.h>

#include <memory>
#include <optional>

#include "innermap/fit/mapped_solid.h"
#include "innermap/transfer/geometry.h"
#include "innermap/transfer/inverse_map.h"
#include "innermap/transfer/push_pull.h"
#include "jobs/needs.h"

namespace innermap {

// Voxels of the grids that are made of others: as chosen, else the finest of theirs times `growth`.
LevelSetSettings carriedVoxels(const openvdb::GridPtrVec& grids, const LatticeChoice& choice,
                               double growth = 1);

// What the map fades to around a solid: this motion, or the best rigid one of the surface; neither:
// it ends there.
struct FadeTo {
  std::optional<RigidMotion> motion;
  bool fitted = false;
};

OutsideSettings outsideSettings(double distance, const FadeTo& fade, const MappedSolid& mapped);
// The motion that is fitted is each frame's own.
FrameOutside frameOutside(double distance, const FadeTo& fade);

// Points by the map, or by what stands for it, or back. They are kept in double precision and may
// go there and back, so their sums are at least as exact as usual.
PointCarry pointCarry(const SolidMap& map, const MappedSolid& mapped, bool push,
                      const OutsideSettings& outside);
// subdivide: fraction of the diagonal of what is carried to.
CarryGeometrySettings carryGeometrySettings(const MappedSolid& mapped, bool push, double subdivide,
                                            SplatOpacity splats);

struct CarryJob {
  bool push = true;  // else pull
  std::shared_ptr<const MappedSolid> mapped;
  Solid target;  // that the map's target bounds
  SolidMap map;  // mapped's, or that of cells which stand for it
  openvdb::GridPtrVec grids;
  CarrySettings carry;
  OutsideSettings outside;
  LatticeChoice lattice;  // of the output

  // The solid that the grids are in, and the one that they go to.
  const Solid& from() const { return push ? mapped->solid() : target; }
  const Solid& to() const { return push ? target : mapped->solid(); }
  // By how much voxels grow that nobody chose.
  double growth() const { return voxelGrowth(from().volume(), to().volume()); }
  LevelSetSettings output() const { return carriedVoxels(grids, lattice, growth()); }
  MemoryNeed need() const;
};

VolumePusher pusherOf(const CarryJob& job);

// With the target's level set, which the puller looks at.
struct Puller {
  openvdb::FloatGrid::Ptr target;
  VolumePuller puller;
};
Puller pullerOf(const CarryJob& job);

// Of pushing in shares: see pushBlocks().
PushSettings pushSettings(const CarryJob& job);

}  // namespace innermap
