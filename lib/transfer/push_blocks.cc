#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "innermap/core/error.h"
#include "levelset/level_set_settings.h"
#include "transfer/detail/invert_block.h"
#include "transfer/detail/volume_pusher.h"

namespace innermap {
namespace {

using openvdb::Coord;

// Of the blocks' grids beside the outputs: where the target is active; what densities bring there.
constexpr const char* kRegion = "region";
constexpr const char* kVolume = "volume";
constexpr const char* kMass = "mass";

// Of a cube of a density, after its place: the density's, and DepositFigures.
constexpr std::size_t kCubeNumbers = 5;

openvdb::DoubleGrid::Ptr sumsGrid(const VoxelSums& sums, double VoxelSums::Sum::*of,
                                  const std::string& name,
                                  const openvdb::math::Transform& transform) {
  const auto out = openvdb::DoubleGrid::create(0);
  out->setTransform(transform.copy());
  out->setName(name);
  for (const auto& [origin, leafSums] : sums.leaves()) {
    auto* leaf = out->tree().touchLeaf(origin);
    for (openvdb::Index i = 0; i < leaf->SIZE; ++i)
      if (std::abs(leafSums[i].*of) > 0) leaf->setValueOn(i, leafSums[i].*of);
  }
  return out;
}

GridBlock cubeBlock(const VoxelBlock& block, const DepositedDensity& made,
                    const openvdb::math::Transform& transform) {
  const DepositFigures& f = made.figures;
  const BlockSums sums{
      block.origin,
      {1.0 * block.density, static_cast<double>(f.cells), static_cast<double>(f.kept),
       static_cast<double>(f.turned), f.largestCompression}};
  return {{sumsGrid(made.sums, &VoxelSums::Sum::volume, kVolume, transform),
           sumsGrid(made.sums, &VoxelSums::Sum::mass, kMass, transform)},
          totalsOf(sums)};
}

[[noreturn]] void refuse(const GridBlock& block) {
  throw DataError(block.name + ": is no part of a density of this volume; make its share again");
}

// By density and place among its cubes.
using Cubes = std::map<int, std::map<Coord, GridBlock>>;

// Takes those of densities out of all blocks. These come from files, and may hold anything.
Cubes takeCubes(std::vector<GridBlock>& blocks) {
  constexpr double kFarthest = 1e9;
  Cubes out;
  std::vector<GridBlock> others;
  for (GridBlock& block : blocks) {
    const std::vector<double>& t = block.totals;
    if (t.size() != 3 + kCubeNumbers) {
      others.push_back(std::move(block));
      continue;
    }
    for (std::size_t i = 0; i < 4; ++i)
      if (!(std::abs(t[i]) < kFarthest) || std::abs(std::remainder(t[i], 1.0)) > 0) refuse(block);
    const Coord cube(static_cast<int>(t[0]), static_cast<int>(t[1]), static_cast<int>(t[2]));
    if (GridBlock& place = out[static_cast<int>(t[3])][cube]; place.totals.empty())
      place = std::move(block);
    else
      throw DataError(block.name + ": another file holds the same part of the density; remove one");
  }
  blocks = std::move(others);
  return out;
}

void addSums(const GridBlock& block, const openvdb::math::Transform& transform, const char* name,
             double VoxelSums::Sum::*to, VoxelSums& sums) {
  for (const openvdb::GridBase::Ptr& grid : block.grids) {
    if (!grid || grid->getName() != name) continue;
    const auto typed = openvdb::gridPtrCast<openvdb::DoubleGrid>(grid);
    if (!typed || typed->transform() != transform || typed->tree().hasActiveTiles()) break;
    for (auto voxel = typed->cbeginValueOn(); voxel; ++voxel) {
      VoxelSums::Sum sum;
      sum.*to = *voxel;
      sums.add(voxel.getCoord(), sum.volume, sum.mass);
    }
    return;
  }
  refuse(block);
}

DepositedDensity depositedOf(const GridBlock& block, const openvdb::math::Transform& transform) {
  const auto count = [&](std::size_t i) {
    return static_cast<std::uint64_t>(std::clamp(block.totals[i], 0.0, 9e15));
  };
  DepositedDensity out;
  out.figures.cells = count(4);
  out.figures.kept = count(5);
  out.figures.turned = count(6);
  out.figures.largestCompression = block.totals[7];
  addSums(block, transform, kVolume, &VoxelSums::Sum::volume, out.sums);
  addSums(block, transform, kMass, &VoxelSums::Sum::mass, out.sums);
  return out;
}

}  // namespace

std::vector<VoxelBlock> pushBlocks(const SolidMap& map, const Solid& source,
                                   const openvdb::GridPtrVec& grids, const PushSettings& settings,
                                   const Solid& target, const LevelSetSettings& output) {
  std::vector<VoxelBlock> out = voxelBlocks(target, output);
  const double to = emptyLevelSet(target, output)->voxelSize()[0];
  std::optional<double> grown;
  for (std::size_t g = 0; g < grids.size(); ++g) {
    if (!isDensity(*grids[g], settings.carry)) continue;
    if (!grown) grown = meanGrowth(map, source, settings.accuracy);
    const auto parts =
        static_cast<std::uint64_t>(densitySettings(*grids[g], *grown, to, settings.carry).parts);
    const openvdb::MaskTree voxels = activeNear(*grids[g], source, settings.outside);
    for (const auto& [cube, count] : densityCubes(voxels, static_cast<int>(parts)))
      out.push_back({cube, count * parts * parts * parts, static_cast<int>(g) + 1});
  }
  return out;
}

struct BlockPusher::Data {
  std::shared_ptr<const VolumePusher::Data> pusher;
  SolidMap map;
  const Solid& target;
  LevelSetSettings output;
  openvdb::FloatGrid::Ptr nothing;      // of the output
  std::optional<LatticeImages> images;  // once a block is pushed
  std::optional<double> grown;          // once it is needed

  InvertedMap inverted(const openvdb::FloatGrid& levelSet);
  CarryDensitySettings settingsOf(const DensityVoxels& density);
  GridBlock pushDensity(const VoxelBlock& block);
  void joinDensities(Cubes cubes, const openvdb::MaskGrid& region, PushResult& out);
};

BlockPusher::BlockPusher(const VolumePusher& pusher, const SolidMap& map, const Solid& target,
                         const LevelSetSettings& output)
    : data_(std::make_shared<Data>(
          Data{pusher.data_, map, target, output, emptyLevelSet(target, output), {}, {}})) {
  requireNoOutside(pusher.data_->settings.outside);
}

InvertedMap BlockPusher::Data::inverted(const openvdb::FloatGrid& levelSet) {
  const VolumePusher::Data& d = *pusher;
  const InverseSettings inverse = inverseSettings(d.settings);
  if (map.pointwise()) return invertMap(map, d.source, d.lattice, levelSet, inverse);
  const ComposedMap& harmonic = *map.harmonic();
  if (!images) images = imagesOf(harmonic, d.source, d.lattice, levelSet.transform(), inverse);
  return invertBlock(harmonic, d.source, d.lattice, *images, levelSet, inverse);
}

CarryDensitySettings BlockPusher::Data::settingsOf(const DensityVoxels& density) {
  const VolumePusher::Data& d = *pusher;
  if (!grown) grown = meanGrowth(map, d.source, d.settings.accuracy);
  return densitySettings(*density.grid, *grown, nothing->voxelSize()[0], d.settings.carry);
}

GridBlock BlockPusher::Data::pushDensity(const VoxelBlock& block) {
  // As one run has it: copies of a transform differ from it in the last bits.
  const openvdb::math::Transform::Ptr transform = nothing->transform().copy();
  for (const auto& [place, voxels] : pusher->densities)
    if (place + 1 == static_cast<std::size_t>(block.density))
      return cubeBlock(block,
                       carryDensityCube(voxels, pusher->extended(map), *transform,
                                        settingsOf(voxels), block.origin),
                       *transform);
  throw DataError(fmt::format("block of density {}: there is no such density", block.density));
}

GridBlock BlockPusher::push(const VoxelBlock& block) const {
  if (block.density > 0) return data_->pushDensity(block);
  const VolumePusher::Data& d = *data_->pusher;
  const openvdb::FloatGrid::Ptr levelSet =
      makeLevelSetBlock(data_->target, data_->output, block.origin);
  GridBlock out;
  openvdb::MaskGrid::Ptr region;
  std::vector<BlockFigures> figures;
  if (d.sampled.empty()) {
    region = d.regionOf(*levelSet);
    figuresAt(block.origin, figures).inverse.voxels = region->activeVoxelCount();
  } else {
    const InvertedMap inverted = data_->inverted(*levelSet);
    region = inverted.region;
    const CarryOutput output(d.sampled, *region, *levelSet);
    d.carrySampled(inverted, output);
    figures = resamplingOf(inverted, *levelSet, d.grids);
    figuresAt(block.origin, figures).inverse = inverted.statistics;
    out.grids = output.blockGrids();
  }
  if (!d.densities.empty()) {
    out.grids.push_back(region->copyGrid());
    out.grids.back()->setName(kRegion);
  }
  out.totals = totalsOf(sumsOf(figures.front()));
  return out;
}

void BlockPusher::Data::joinDensities(Cubes cubes, const openvdb::MaskGrid& region,
                                      PushResult& out) {
  for (const auto& [place, voxels] : pusher->densities) {
    DepositedDensity all;
    for (auto& [cube, block] : cubes[static_cast<int>(place) + 1]) {
      all.add(depositedOf(block, nothing->transform()));
      block.grids.clear();
    }
    cubes.erase(static_cast<int>(place) + 1);
    out.masses.emplace_back();
    out.grids[place] = densityGrid(voxels, all, region, out.masses.back(), settingsOf(voxels));
  }
  for (const auto& [density, blocks] : cubes) refuse(blocks.begin()->second);
}

PushResult BlockPusher::join(std::vector<GridBlock> blocks) const {
  const VolumePusher::Data& d = *data_->pusher;
  const openvdb::FloatGrid& nothing = *data_->nothing;
  Cubes cubes = takeCubes(blocks);
  GridBlocks all(std::move(blocks), data_->nothing->transformPtr(), kCarryNumbers);
  const CarryFigures figures = sumOf(all, voxelsOf(d.grids, nothing.voxelSize()[0]));
  const openvdb::MaskGrid::Ptr region = d.regionOf(nothing);
  PushResult out;
  if (d.sampled.empty()) {
    out = d.uninverted(figures.inverse.voxels);
  } else {
    CarryOutput output(d.sampled, *region, nothing);
    output.take(all);
    requireInverted(figures.inverse);
    out = d.result(figures);
    d.finish(data_->map, output, out.grids);
  }
  if (!d.densities.empty()) all.mergeInto(*region, kRegion);
  data_->joinDensities(std::move(cubes), *region, out);
  noteOutside(out.grids, d.settings.outside);
  return out;
}

}  // namespace innermap
