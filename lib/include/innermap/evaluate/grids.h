// A map on the voxels of its solid, ready to be written: level set, fog, positions, Jacobian and
// energies, with the map's facts in their metadata.
#pragma once

#include <openvdb/openvdb.h>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "innermap/core/run.h"
#include "innermap/core/setting.h"
#include "innermap/evaluate/evaluate_map.h"
#include "innermap/field/field_file.h"
#include "innermap/field/harmonic_field.h"
#include "innermap/fit/frame_fitter.h"
#include "innermap/fit/mapped_solid.h"
#include "innermap/levelset/level_set.h"
#include "innermap/levelset/solid.h"

namespace innermap {

class FieldRegion;

// Whether to repair folds (EvaluateSettings::repairUpTo). automatic: if at most kRepairedFolds of
// the voxels inside fold, and not in sequences.
enum class RepairFolds { automatic, on, off };
constexpr double kRepairedFolds = 5e-3;
Setting repairSetting(RepairFolds* repair);

struct MapGridSettings {
  int resolution = 0;    // voxels along the longest side, as in LevelSetSettings
  double voxelSize = 0;  // world units; above 0: in place of the resolution
  LameConstants lame;
  RepairFolds repair = RepairFolds::automatic;
};

constexpr double kUsualTolerance = 1e-3;

struct SolidGrids {
  openvdb::FloatGrid::Ptr surface, density;  // level set, and fog of the inside
  MapGrids values;                           // with their totals; map: absolute positions
  // Far from the origin, where floats hold positions to less than a tenth of the tolerance that the
  // map was fitted to (of kUsualTolerance, if to none), also `map_local`: positions less
  // localOrigin, which floats hold well; folds are looked for in these. Null otherwise.
  openvdb::Vec3fGrid::Ptr mapLocal;
  Vec3 localOrigin;
  // How far the image of each voxel inside lies outside the target, world units of that; active
  // where that is more than the error of 99% of the boundary. Null where nothing does.
  openvdb::FloatGrid::Ptr outside;
  // Active, and 1, at the voxels inside whose cells the proof that nothing folds left undecided.
  // Null if there are none, or if the map comes from a file. The cells that it proves folded are in
  // values.folded.
  openvdb::FloatGrid::Ptr undecided;
  double outsideFraction = 0;  // their share of the voxels inside
  double mapRounding = 0;      // MapGrids::rounding, fraction of the target's diagonal
  double voxelSize = 0;        // world units
  Injectivity injectivity;     // of the map, with what voxels and cells tell
  std::vector<std::string> notes, warnings;
  StageSeconds seconds;  // "voxelize", "evaluate", "outside", "cells"

  // As mapGridNames(), and `repaired`, `folded`, `undecided`, `outside` and `map_local` where there
  // are such.
  openvdb::GridPtrVec all() const;
};

// Metadata (prefix innermap_): the map's facts, harmonic_energy_total, deformation_energy_total,
// jacobian_min, jacobian_max, folded_fraction, outside_fraction, map_rounding
// (SolidGrids::mapRounding), lame_lambda, lame_mu; map_local_origin (Vec3d) where there is that
// grid; one_to_one, which is what injectivityStatement says. Throws SettingError, MemoryError,
// DataError (thinner than the voxels everywhere), Cancelled. Deterministic for any number of
// threads.
SolidGrids evaluateOnGrid(const MappedSolid& mapped, const MapGridSettings& settings = {});

// How mapGridMemory() counts: harmonic maps one after another, whether there is a map_local, and
// whether a FrameEvaluator makes the grids, which does not look at the cells between the voxels.
struct MapGridKind {
  std::size_t steps = 1;
  bool local = false, frame = false;
};
MapGridKind mapGridKind(const MappedSolid& mapped);

// The same in shares: block by block, on whichever machine, and joined to the grids of one run.

// A cube of 128 voxels along each side; its origin, the lowest of them, is a multiple of that.
struct VoxelBlock {
  openvdb::Coord origin;
  std::uint64_t voxels = 0;  // inside, roughly; along the surface as many as take that long
  // Above 0 of pushBlocks() alone: a cube of voxels of the source, of the density at this place
  // among the grids, counted from 1; `origin` is its place among the cubes.
  int density = 0;
};

// Those in which a level set of the solid may have voxels inside or in its band, ascending by
// origin: the same on all machines. Throws SettingError, Cancelled.
std::vector<VoxelBlock> voxelBlocks(const Solid& solid, const LevelSetSettings& settings);

// What a share makes of a block: of one run's grids the voxels of this block, as far as they can be
// made without the others.
struct GridBlock {
  openvdb::GridPtrVec grids;                   // outside the block they are empty
  std::vector<double> totals;                  // its origin, and sums, for what joins the blocks
  std::string name = "a block of the volume";  // for errors: its file, say
};

// surface, map (less SolidGrids::localOrigin), jacobian, harmonic_energy and deformation_energy,
// before repair. Its memory does not grow with the number of voxels of the whole. Throws as
// evaluateOnGrid().
GridBlock evaluateBlock(const MappedSolid& mapped, const MapGridSettings& settings,
                        const openvdb::Coord& origin);

// What evaluateOnGrid() returns, to the bit, from all blocks, each once: repairs folds, looks at
// cells and sums totals. Takes the blocks' voxels. Throws DataError for grids that are no such
// blocks of this map, and as evaluateOnGrid().
SolidGrids joinBlocks(const MappedSolid& mapped, const MapGridSettings& settings,
                      std::vector<GridBlock> blocks);

// Need of evaluateBlock() in bytes, of any block.
std::uint64_t mapBlockMemory(const MapGridKind& kind);

// The same of makeLevelSet() and, with a mesh, makeAttributeGrids(): these grids, in this order.
GridBlock voxelizeBlock(const Solid& solid, const LevelSetSettings& settings,
                        const Mesh* attributes, const openvdb::Coord& origin);
openvdb::GridPtrVec joinVoxelized(const Solid& solid, const LevelSetSettings& settings,
                                  std::vector<GridBlock> blocks);

// The maps of a sequence's frames on the voxels of its rest pose.
class FrameEvaluator {
 public:
  // names: grids to be had beside the totals, of mapGridNames(). fitter: must outlive it. Throws
  // SettingError, MemoryError, DataError (thinner than the voxels everywhere), Cancelled.
  explicit FrameEvaluator(const FrameFitter& fitter, std::vector<std::string> names = {},
                          const MapGridSettings& settings = {});

  double voxelSize() const { return surface_->voxelSize()[0]; }  // world units
  const std::vector<std::string>& warnings() const { return warnings_; }
  const StageSeconds& seconds() const { return seconds_; }  // "voxelize"

  // fit: of the fitter. Throws MemoryError, Cancelled. The same for any number of threads.
  MapGrids evaluate(const FrameFit& fit) const;

  // The grids of these names, in their order, with the frame's facts (describeFrame) and the totals
  // of evaluateOnGrid in their metadata. values: of that frame.
  openvdb::GridPtrVec grids(const NumberedFit& frame, const MapGrids& values) const;

 private:
  bool wants(const char* name) const;

  const FrameFitter& fitter_;
  std::vector<std::string> names_;
  EvaluateSettings evaluate_;  // what all frames have in common
  openvdb::FloatGrid::Ptr surface_, density_;
  openvdb::MaskGrid::Ptr mask_;
  std::shared_ptr<FieldRegion> region_;
  std::vector<std::string> warnings_;
  StageSeconds seconds_;
};

// surface, density, map, jacobian, harmonic_energy, deformation_energy.
const std::vector<std::string>& mapGridNames();

// Whether a target of these vertices, in world units, stands so far from the origin that the grid
// `map_local` is made too: floats hold positions no better than to a tenth of the tolerance, a
// fraction of its diagonal.
bool needsLocalMap(const Points& target, double tolerance);

// Need of evaluateOnGrid() in bytes, from the solid's volume and area. Throws Cancelled.
std::uint64_t mapGridMemory(const Solid& solid, const MapGridSettings& settings,
                            const MapGridKind& kind = {});

// The map's facts as metadata of grids made with it (prefix innermap_); of its injectivity the
// statement, one_to_one.
void describeMap(const openvdb::GridPtrVec& grids, const MappedSolid& mapped);

// The same of grids made with the map of an animation's frame: frame (its number),
// boundary_error_rms, boundary_error_p99, boundary_error_max, boundary_error_bound.
void describeFrame(const openvdb::GridPtrVec& grids, const NumberedFit& frame);

// A harmonic field on the voxels of its solid: values, gradients, their directions and lengths.

struct HarmonicGridSettings {
  int resolution = 128;  // voxels along the longest side of the solid, in [4, 4096]
  double voxelSize = 0;  // world units; above 0: in place of the resolution
  bool values = true, gradients = true, directions = true, magnitudes = true;
  double accuracy = 1e-7;  // of the sums, fraction of `span`, in [1e-12, 1e-3]
  double span = 1;         // of the values, in their units, above 0
};

struct HarmonicGrids {
  openvdb::FloatGrid::Ptr surface, density;  // level set, and fog of the inside
  // Of each channel, in order, what was asked for: NAME (float), NAME_gradient (vec3s, values'
  // units per world unit), NAME_direction (its unit vector; 0 where it is 0), NAME_magnitude (its
  // length). Active inside and in a skin of two voxels, where values go on from the closest point
  // of the boundary, as those of maps do (MapGrids). Background 0.
  openvdb::GridPtrVec fields;
  std::uint64_t activeVoxels = 0, interiorVoxels = 0;
  double voxelSize = 0;  // world units
  std::vector<std::string> warnings;
  StageSeconds seconds;  // "voxelize", "evaluate"

  openvdb::GridPtrVec all() const;
};

// names: of the channels. Throws SettingError (a setting out of range; names that are empty, twice,
// or not one a channel), MemoryError, DataError (thinner than the voxels everywhere), Cancelled.
// The same for any number of threads.
HarmonicGrids evaluateHarmonic(const HarmonicField& field, const Solid& solid,
                               const std::vector<std::string>& names,
                               const HarmonicGridSettings& settings = {});

// The field's facts as metadata of its grids (prefix innermap_).
void describeField(const openvdb::GridPtrVec& grids, const Facts& facts);

// Need in bytes of the grids of so many channels.
std::uint64_t harmonicGridMemory(const Solid& solid, std::size_t channels,
                                 const HarmonicGridSettings& settings = {});

}  // namespace innermap
