// Push forward: grids that live in a source solid, carried to the target by the solid's map.
//
// For each voxel q of the target, finds the point p with f(p) = q: it maps the cells of a lattice
// through the source, starts in those whose image holds q, and goes on by Newton steps with the
// analytic Jacobian. It samples the grids at p.
//
// Samples of a density would lose what the map crushes below a voxel. So densities are remapped,
// and keep their mass whatever the map does. Each of their voxels, or parts of it if the target's
// are finer, is cut into six tetrahedra whose corners are mapped; the image of each is cut along
// the target's voxels, which get what their parts hold (Powell and Abel, "An exact general
// remeshing scheme applied to physically conservative voxelization", J. Comput. Phys. 297, 2015).
// Within a voxel of the source a density is linear, with limited slopes (Dukowicz and Kodis,
// "Accurate conservative remapping (rezoning) for arbitrary Lagrangian-Eulerian computations", SIAM
// J. Sci. Stat. Comput. 8, 1987), constant with Sampling::nearest. So a voxel of the target has the
// mean over it; a density does not change where nothing moves. Parts of the solid that touch within
// a voxel of the source go each their own way.
#pragma once

#include <openvdb/openvdb.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "innermap/evaluate/grids.h"
#include "innermap/field/harmonic_field.h"
#include "innermap/fit/frame_fitter.h"
#include "innermap/levelset/level_set.h"
#include "innermap/levelset/solid.h"
#include "innermap/transfer/carry.h"
#include "innermap/transfer/inverse_map.h"

namespace innermap {

struct PushSettings {
  CarrySettings carry;
  OutsideSettings outside;
  double skin = 2;          // active voxels outside the target's surface, in [0, 3]
  double tolerance = 1e-3;  // of f(p) = q, target voxels, in [1e-6, 0.01]
  double accuracy = 1e-7;   // of the sums of charges, as EvaluateSettings::accuracy
};

struct PushResult {
  openvdb::GridPtrVec grids;  // in the order given, then the fields
  // Of the inverse, which is taken where there is something to sample: other grids than densities,
  // or fields. Without, the number of voxels alone.
  bool inverted = false;
  InverseStatistics statistics;
  std::vector<CarriedMass> masses;  // of grids carried as densities
  ResamplingFigures resampling;     // of the voxels inside, where there is an inverse
  std::vector<std::string> warnings;
};

// Keeps all that depends on the source alone; serves any number of maps (the frames of a sequence).
// Immutable; one push at a time uses all threads.
class VolumePusher {
 public:
  // Throws DataError for a grid of a type that cannot be carried, a tensor with a part missing or
  // no active voxel near the solid in any grid; SettingError; MemoryError; Cancelled.
  VolumePusher(const Solid& source, const openvdb::GridPtrVec& grids,
               const PushSettings& settings = {});

  // targetLevelSet: of the target, class level set, half-width at least the skin; its transform is
  // that of the output. Output grids keep name, class, background, vector type and metadata; they
  // are active where the target's signed distance is at most the skin. Level sets are rebuilt as
  // distances; where one is the source's own surface, to a voxel, it becomes the target's. With
  // outside settings, also where the volume around the source comes to. Densities are active also
  // where mass of theirs comes to beyond that. Throws as invertMap does. Same result for any number
  // of threads.
  PushResult push(const SolidMap& map, const openvdb::FloatGrid& targetLevelSet,
                  const std::vector<CarriedField>& fields = {}) const;

 private:
  friend class BlockPusher;
  struct Data;
  std::shared_ptr<const Data> data_;
};

// All blocks of BlockPusher: voxelBlocks(target, output), and of each density cubes of its own
// voxels, which go where the map takes them. Throws as voxelBlocks(), DataError for a density whose
// transform is not linear.
std::vector<VoxelBlock> pushBlocks(const SolidMap& map, const Solid& source,
                                   const openvdb::GridPtrVec& grids, const PushSettings& settings,
                                   const Solid& target, const LevelSetSettings& output);

// VolumePusher::push() in shares (evaluate/grids.h), to the level set that makeLevelSet(target,
// output) is, without outside settings and fields.
class BlockPusher {
 public:
  // Throws SettingError for outside settings. target: must outlive it.
  BlockPusher(const VolumePusher& pusher, const SolidMap& map, const Solid& target,
              const LevelSetSettings& output);

  // One of pushBlocks(): its voxels, or the volume and mass that its voxels bring to the target's.
  // Throws as VolumePusher::push. One at a time.
  GridBlock push(const VoxelBlock& block) const;
  // From all blocks, each once, what push() of one run returns, to the bit: masses are added, level
  // sets become distances, and positions are moved there. Throws as that, DataError for what are no
  // such blocks.
  PushResult join(std::vector<GridBlock> blocks) const;

 private:
  struct Data;
  std::shared_ptr<Data> data_;
};

struct FramePushSettings {
  PushSettings push;
  bool fadeToFitted = false;  // what lies outside fades to the best rigid motion of each frame
  LevelSetSettings output;    // of the rest pose: all frames get its voxels and its lattice
};

struct FramePush {
  PushResult result;
  StageSeconds seconds;  // "level set", "push"
};

// Grids that live in a rest pose, carried through the frames of an animation. What a frame gives
// does not depend on the others.
class FramePusher {
 public:
  // fitter: must outlive it. Throws as VolumePusher.
  FramePusher(const FrameFitter& fitter, const openvdb::GridPtrVec& grids,
              const FramePushSettings& settings = {});

  double voxelSize() const { return settings_.output.voxelSize; }  // of the outputs, world units

  // fit: of the fitter. The grids have the frame's facts in their metadata, see describeFrame.
  // Throws as VolumePusher::push, DataError for a frame that bounds no solid.
  FramePush push(const NumberedFit& fit, const std::vector<CarriedField>& fields = {}) const;

 private:
  VolumePusher pusherFor(const Points& moved) const;

  const FrameFitter& fitter_;
  openvdb::GridPtrVec grids_;
  FramePushSettings settings_;
  std::optional<VolumePusher> pusher_;  // none where each frame needs its own
};

// Pull back: grids that live in the target, brought to the source by the solid's map.

struct PullSettings {
  CarrySettings carry;
  OutsideSettings outside;
  double skin = 2;         // active voxels outside the surface, in [0, 3]
  double accuracy = 1e-7;  // of the sums of charges, as EvaluateSettings::accuracy
  // Of the target's solid, half-width at least 3 voxels; null when it is not known. With it,
  // attributes that end at the target's surface are continued by three voxels beyond, so that what
  // is sampled along the surface does not mix with the background; positions need it.
  const openvdb::FloatGrid* targetLevelSet = nullptr;
};

struct PullResult {
  openvdb::GridPtrVec grids;     // in the order given
  std::uint64_t voxels = 0;      // active
  ResamplingFigures resampling;  // of the voxels inside
  std::vector<std::string> warnings;
};

// Keeps all that depends on the grids; immutable. settings.targetLevelSet must outlive it.
class VolumePuller {
 public:
  // Throws as VolumePusher does.
  VolumePuller(const SolidMap& map, const Solid& source, const openvdb::GridPtrVec& grids,
               const PullSettings& settings = {});

  // For each voxel p of the source, the grids' values at f(p), moved back by what they are.
  // levelSet: of `source`, half-width at least the skin; its transform is that of the output, which
  // is active where the signed distance is at most the skin (with outside settings: the outside
  // distance). Names, classes, backgrounds, vector types and metadata stay; level sets are rebuilt
  // as distances, and where one is the target's own surface, to a voxel, it becomes the source's.
  PullResult pull(const openvdb::FloatGrid& levelSet) const;

  // The same in shares (evaluate/grids.h), of the level set that makeLevelSet(source, output) is,
  // without outside settings: the voxels of a block; and from all of them, each once, what pull()
  // returns, to the bit: level sets become distances there, and positions are moved. Throw as
  // pull(), SettingError for outside settings, DataError for what are no such blocks.
  GridBlock pullBlock(const LevelSetSettings& output, const openvdb::Coord& origin) const;
  PullResult join(const LevelSetSettings& output, std::vector<GridBlock> blocks) const;

 private:
  struct Data;
  std::shared_ptr<const Data> data_;
};

// Need of pushing or pulling a block in bytes, of any block, with the grids read already. other:
// the solid that they live in.
std::uint64_t carryBlockMemory(const Solid& other, const openvdb::GridPtrVec& grids,
                               const CarrySettings& carry, bool pushed);

// One of them.
PullResult pullGrids(const SolidMap& map, const Solid& source, const openvdb::FloatGrid& levelSet,
                     const openvdb::GridPtrVec& grids, const PullSettings& settings = {});

}  // namespace innermap
