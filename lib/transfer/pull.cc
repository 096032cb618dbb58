#include "core/require_number.h"
#include "evaluate/active_region.h"
#include "evaluate/grid_blocks.h"
#include "innermap/core/error.h"
#include "innermap/evaluate/evaluate_map.h"
#include "innermap/transfer/inverse_map.h"
#include "innermap/transfer/push_pull.h"
#include "levelset/level_set_settings.h"
#include "transfer/detail/block_figures.h"
#include "transfer/detail/carry_output.h"
#include "transfer/detail/extended_map.h"
#include "transfer/detail/source_lattice.h"

namespace innermap {

struct VolumePuller::Data {
  SolidMap map;
  Solid source;
  openvdb::GridPtrVec grids;
  PullSettings settings;
  double accuracy = 0;  // world units of the target
  Carriers carriers;
  std::vector<std::string> warnings;

  ExtendedMap extended(const openvdb::FloatGrid& levelSet) const {
    return {map, source, levelSet, settings.outside, accuracy};
  }
  openvdb::MaskGrid::Ptr region(const ExtendedMap& extended) const;
  Points movedBack(const Points& positions) const;
  std::vector<BlockFigures> carry(const ExtendedMap& extended, const openvdb::MaskGrid& region,
                                  const CarryOutput& output) const;
  PullResult conclude(const CarryFigures& all, CarryOutput& output) const;
};

// Of the source's solid, and what is around it as far as the map is extended.
openvdb::MaskGrid::Ptr VolumePuller::Data::region(const ExtendedMap& extended) const {
  RegionSettings inside;
  inside.skin = settings.skin;
  inside.bytesPerVoxel = outputBytesPerVoxel(grids);
  openvdb::MaskGrid::Ptr region = activeRegion(extended.levelSet(), inside);
  if (!(settings.outside.distance > 0)) return region;
  addAround(*region, source, extended.reach(), outputBytesPerVoxel(grids) + 16);
  return region;
}

// The inverse map at positions of the target, found only when a grid holds positions.
Points VolumePuller::Data::movedBack(const Points& positions) const {
  if (map.pointwise()) {
    Points out;
    for (const PointImage& s : map.pull(positions)) out.push_back(s.image);
    return out;
  }
  if (!settings.targetLevelSet)
    throw DataError(
        "pull: positions (contravariant absolute vectors) need the "
        "target's level set");
  const SourceLattice lattice = makeSourceLattice(source, {}, {});
  InverseSettings inverse;
  inverse.accuracy = settings.accuracy;
  const InvertedMap inverted = invertMap(map, source, lattice, *settings.targetLevelSet, inverse);
  return invertAt(*map.harmonic(), source, lattice, inverted, positions, inverse);
}

// What it tells of each block, in their order.
std::vector<BlockFigures> VolumePuller::Data::carry(const ExtendedMap& extended,
                                                    const openvdb::MaskGrid& region,
                                                    const CarryOutput& output) const {
  std::vector<ResamplingFigures> parts(region.tree().leafCount(),
                                       voxelsOf(grids, extended.levelSet().voxelSize()[0]));
  extended.visit(
      region,
      [&](std::size_t number, const LeafValues& leaf, const std::vector<PointImage>& samples) {
        std::vector<Site> sites;
        for (std::size_t i = 0; i < samples.size(); ++i) {
          const PointImage& s = samples[i];
          sites.push_back({s.image, s.image, inverse(s.jacobian)});
          if (leaf.inside[i]) parts[number].add(1 / determinant(s.jacobian));
        }
        output.carry(leaf.origin, sites.data());
      },
      "pulling the grids");
  std::vector<BlockFigures> blocks;
  std::size_t number = 0;
  for (auto leaf = region.tree().cbeginLeaf(); leaf; ++leaf, ++number) {
    CarryFigures& figures = figuresAt(blockOf(leaf->origin()), blocks);
    figures.inverse.voxels += leaf->onVoxelCount();
    figures.resampling.add(parts[number]);
  }
  return blocks;
}

PullResult VolumePuller::Data::conclude(const CarryFigures& all, CarryOutput& output) const {
  PullResult out;
  out.warnings = warnings;
  out.grids.resize(grids.size());
  output.finish([&](const Points& points) { return movedBack(points); }, out.grids);
  noteOutside(out.grids, settings.outside);
  out.voxels = all.inverse.voxels;
  out.resampling = all.resampling;
  out.resampling.finish();
  return out;
}

VolumePuller::VolumePuller(const SolidMap& map, const Solid& source,
                           const openvdb::GridPtrVec& grids, const PullSettings& settings) {
  requireNumber("accuracy", settings.accuracy, {1e-12, 1e-3}, "of the target's extent");
  auto data = std::make_shared<Data>(
      Data{map, source, grids, settings, settings.accuracy * map.targetDiagonal(source), {}, {}});
  const openvdb::FloatGrid* target = settings.targetLevelSet;
  if (target && !(settings.outside.distance > 0))
    requireMeeting(grids, *target, "of the map's target", data->warnings);
  data->carriers = makeCarriers(grids, settings.carry, target);
  data_ = std::move(data);
}

PullResult VolumePuller::pull(const openvdb::FloatGrid& levelSet) const {
  const ExtendedMap extended = data_->extended(levelSet);
  const openvdb::MaskGrid::Ptr region = data_->region(extended);
  CarryOutput output(data_->carriers, *region, levelSet);
  CarryFigures all;
  all.resampling = voxelsOf(data_->grids, levelSet.voxelSize()[0]);
  for (const BlockFigures& block : data_->carry(extended, *region, output)) all.add(block.figures);
  return data_->conclude(all, output);
}

GridBlock VolumePuller::pullBlock(const LevelSetSettings& output,
                                  const openvdb::Coord& origin) const {
  requireNoOutside(data_->settings.outside);
  const openvdb::FloatGrid::Ptr levelSet = makeLevelSetBlock(data_->source, output, origin);
  const ExtendedMap extended = data_->extended(*levelSet);
  const openvdb::MaskGrid::Ptr region = data_->region(extended);
  const CarryOutput carried(data_->carriers, *region, *levelSet);
  std::vector<BlockFigures> figures = data_->carry(extended, *region, carried);
  if (figures.empty()) figures.push_back({origin, {}});
  return {carried.blockGrids(), totalsOf(sumsOf(figures.front()))};
}

PullResult VolumePuller::join(const LevelSetSettings& output, std::vector<GridBlock> blocks) const {
  const openvdb::FloatGrid::Ptr nothing = emptyLevelSet(data_->source, output);
  GridBlocks all(std::move(blocks), nothing->transformPtr(), kCarryNumbers);
  CarryOutput carried(data_->carriers, *data_->region(data_->extended(*nothing)), *nothing);
  carried.take(all);
  return data_->conclude(sumOf(all, voxelsOf(data_->grids, nothing->voxelSize()[0])), carried);
}

PullResult pullGrids(const SolidMap& map, const Solid& source, const openvdb::FloatGrid& levelSet,
                     const openvdb::GridPtrVec& grids, const PullSettings& settings) {
  return VolumePuller(map, source, grids, settings).pull(levelSet);
}

}  // namespace innermap
