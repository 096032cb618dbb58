#include <fmt/format.h>
#include <openvdb/tools/Interpolation.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "evaluate/active_region.h"
#include "innermap/core/error.h"
#include "innermap/core/run.h"
#include "innermap/evaluate/evaluate_map.h"
#include "innermap/evaluate/grids.h"
#include "innermap/transfer/push_pull.h"
#include "levelset/level_set_settings.h"
#include "transfer/detail/block_figures.h"
#include "transfer/detail/carry_density.h"
#include "transfer/detail/carry_output.h"
#include "transfer/detail/density_voxels.h"
#include "transfer/detail/extended_map.h"
#include "transfer/detail/field_grid.h"
#include "transfer/detail/invert_block.h"
#include "transfer/detail/source_lattice.h"

namespace innermap {
namespace {

InverseSettings inverseSettings(const PushSettings& s) {
  InverseSettings out;
  out.outside = s.outside;
  out.skin = s.skin;
  out.tolerance = s.tolerance;
  out.accuracy = s.accuracy;
  return out;
}

// Cells along the edge of a density's voxels, so that their images are about as fine as the
// target's voxels.
int partsOf(const openvdb::GridBase& density, const Solid& source,
            const openvdb::FloatGrid& target) {
  constexpr double kLarger = 0.75;  // than the target's voxels, at most
  constexpr int kMost = 32;
  const openvdb::Vec3d voxel = density.voxelSize();
  const double to = target.voxelSize()[0];
  const double volume = static_cast<double>(interiorVoxels(target)) * std::pow(to, 3);
  const double grown = std::cbrt(volume / source.volume());
  const double ratio = std::max({voxel.x(), voxel.y(), voxel.z()}) * grown / to;
  return std::clamp(static_cast<int>(ratio + 1 - kLarger), 1, kMost);
}

// Of each block, in their order.
std::vector<BlockFigures> resamplingOf(const InvertedMap& inverted,
                                       const openvdb::FloatGrid& target,
                                       const openvdb::GridPtrVec& grids) {
  const ResamplingFigures voxels = voxelsOf(grids, target.voxelSize()[0]);
  const auto distance = target.getConstAccessor();
  std::vector<BlockFigures> out;
  std::size_t next = 0;
  for (auto leaf = inverted.region->tree().cbeginLeaf(); leaf; ++leaf) {
    ResamplingFigures here = voxels;
    for (auto voxel = leaf->cbeginValueOn(); voxel; ++voxel, ++next) {
      if (!(distance.getValue(voxel.getCoord()) < 0)) continue;
      Mat3 jacobian;
      for (std::size_t k = 0; k < 9; ++k)
        jacobian[k / 3][k % 3] = static_cast<double>(inverted.jacobians[next][k]);
      here.add(determinant(jacobian));
    }
    figuresAt(blockOf(leaf->origin()), out).resampling.add(here);
  }
  return out;
}

}  // namespace

struct VolumePusher::Data {
  Solid source;
  openvdb::GridPtrVec grids;
  PushSettings settings;
  SourceLattice lattice;
  Carriers sampled;
  std::vector<std::pair<std::size_t, DensityVoxels>> densities;  // by place among the grids
  std::vector<std::string> warnings;

  openvdb::MaskGrid::Ptr regionOf(const openvdb::FloatGrid& target) const;
  PushResult result(const CarryFigures& figures) const;
  ExtendedMap extended(const ComposedMap& map) const;
  Vec3 inSolid(const Vec3& p) const;
  void carrySampled(const InvertedMap& inverted, const CarryOutput& output) const;
  void finish(const ComposedMap& map, CarryOutput& output, openvdb::GridPtrVec& out) const;
  void carryDensities(const ComposedMap& map, const openvdb::FloatGrid& target,
                      const openvdb::MaskGrid& region, PushResult& out) const;
};

VolumePusher::VolumePusher(const Solid& source, const openvdb::GridPtrVec& grids,
                           const PushSettings& settings) {
  requireInRange(inverseSettings(settings));
  auto data = std::make_shared<Data>(Data{source, grids, settings, {}, {}, {}, {}});
  data->lattice = makeSourceLattice(source, settings.outside, grids);
  const openvdb::FloatGrid& levelSet = *data->lattice.levelSet;
  if (!grids.empty() && !(settings.outside.distance > 0))
    requireMeeting(grids, levelSet, source.surface().name, data->warnings);
  for (auto& carrier : makeCarriers(grids, settings.carry, &levelSet)) {
    if (carrier->isDensity()) {
      const std::size_t place = carrier->places().front();
      if (settings.through)
        throw DataError("grid " + grids[place]->getName() +
                        ": densities go by the map alone, not through a mesh; leave it out or let "
                        "it be sampled");
      data->densities.emplace_back(place,
                                   densityVoxels(grids[place], source, levelSet, settings.outside));
    } else {
      data->sampled.push_back(std::move(carrier));
    }
  }
  data_ = std::move(data);
}

openvdb::MaskGrid::Ptr VolumePusher::Data::regionOf(const openvdb::FloatGrid& target) const {
  RegionSettings region;
  region.skin = settings.skin;
  region.bytesPerVoxel = outputBytesPerVoxel(grids);
  return activeRegion(target, region);
}

ExtendedMap VolumePusher::Data::extended(const ComposedMap& map) const {
  return {map, source, *lattice.levelSet, settings.outside,
          settings.accuracy * targetExtent(map, source)};
}

// Where the map crushes the source, the target's boundary error is many of the source's voxels,
// more than attributes are continued by.
Vec3 VolumePusher::Data::inSolid(const Vec3& p) const {
  if (settings.outside.distance > 0) return p;
  const openvdb::FloatGrid& levelSet = *lattice.levelSet;
  const openvdb::Vec3d ijk = levelSet.transform().worldToIndex({p.x, p.y, p.z});
  const double voxel = levelSet.voxelSize()[0];
  if (openvdb::tools::BoxSampler::sample(levelSet.tree(), ijk) < voxel) return p;
  return source.closest(p, std::numeric_limits<double>::infinity()).position;
}

void VolumePusher::Data::carrySampled(const InvertedMap& inverted,
                                      const CarryOutput& output) const {
  std::vector<openvdb::Coord> origins;
  for (auto leaf = inverted.region->tree().cbeginLeaf(); leaf; ++leaf)
    origins.push_back(leaf->origin());
  parallelBlocks(
      origins.size(), 8,
      [&](std::size_t begin, std::size_t end) {
        std::vector<Site> sites;
        for (std::size_t l = begin; l < end; ++l) {
          sites.clear();
          for (std::size_t i = inverted.first[l]; i < inverted.first[l + 1]; ++i) {
            Site site{inverted.sources[i], inSolid(inverted.sources[i]), {}};
            for (std::size_t k = 0; k < 9; ++k)
              site.derivative[k / 3][k % 3] = static_cast<double>(inverted.jacobians[i][k]);
            sites.push_back(site);
          }
          output.carry(origins[l], sites.data());
        }
      },
      "carrying the grids");
}

void VolumePusher::Data::finish(const ComposedMap& map, CarryOutput& output,
                                openvdb::GridPtrVec& out) const {
  output.finish(
      [&](const Points& points) {
        Points images;
        if (settings.through) {
          std::vector<Mat3> jacobians;
          settings.through->push(points, images, jacobians);
          return images;
        }
        for (const ExtendedSample& s : extended(map).at(points)) images.push_back(s.image);
        return images;
      },
      out);
}

void VolumePusher::Data::carryDensities(const ComposedMap& map, const openvdb::FloatGrid& target,
                                        const openvdb::MaskGrid& region, PushResult& out) const {
  const ExtendedMap extendedMap = extended(map);
  for (const auto& [place, voxels] : densities) {
    CarryDensitySettings carry;
    carry.parts = partsOf(*voxels.grid, source, target);
    carry.limit = settings.carry.densityLimit;
    carry.constant = settings.carry.sampling == Sampling::nearest;
    out.masses.emplace_back();
    out.grids[place] = carryDensity(voxels, extendedMap, region, out.masses.back(), carry);
  }
}

// What comes of an inverse, but for the grids.
PushResult VolumePusher::Data::result(const CarryFigures& figures) const {
  PushResult out;
  out.warnings = warnings;
  out.grids.resize(grids.size());
  out.inverted = true;
  out.statistics = figures.inverse;
  const std::string doubt = figures.inverse.warning();
  if (!doubt.empty()) out.warnings.push_back(doubt);
  if (!grids.empty()) out.resampling = figures.resampling;
  out.resampling.finish();
  return out;
}

PushResult VolumePusher::push(const ComposedMap& map, const openvdb::FloatGrid& targetLevelSet,
                              const std::vector<CarriedField>& fields) const {
  const Data& d = *data_;
  PushResult out;
  openvdb::MaskGrid::Ptr region;
  if (d.sampled.empty() && fields.empty()) {
    out.warnings = d.warnings;
    out.grids.resize(d.grids.size());
    region = d.regionOf(targetLevelSet);
    out.statistics.voxels = region->activeVoxelCount();
  } else {
    const InvertedMap inverted =
        d.settings.through
            ? invertThrough(*d.settings.through, d.regionOf(targetLevelSet))
            : invertMap(map, d.source, d.lattice, targetLevelSet, inverseSettings(d.settings));
    region = inverted.region;
    CarryFigures all;
    all.inverse = inverted.statistics;
    all.resampling = voxelsOf(d.grids, targetLevelSet.voxelSize()[0]);
    for (const BlockFigures& block : resamplingOf(inverted, targetLevelSet, d.grids))
      all.add(block.figures);
    out = d.result(all);
    CarryOutput sampled(d.sampled, *region, targetLevelSet);
    d.carrySampled(inverted, sampled);
    d.finish(map, sampled, out.grids);
    for (const CarriedField& field : fields)
      out.grids.push_back(fieldGrid(field, d.source, d.lattice, inverted, d.settings.accuracy));
  }
  d.carryDensities(map, targetLevelSet, *region, out);
  noteOutside(out.grids, d.settings.outside);
  return out;
}

struct BlockPusher::Data {
  std::shared_ptr<const VolumePusher::Data> pusher;
  ComposedMap map;
  const Solid& target;
  LevelSetSettings output;
  std::optional<LatticeImages> images;  // once a block is pushed

  InvertedMap inverted(const openvdb::FloatGrid& levelSet);
};

BlockPusher::BlockPusher(const VolumePusher& pusher, const ComposedMap& map, const Solid& target,
                         const LevelSetSettings& output)
    : data_(std::make_shared<Data>(Data{pusher.data_, map, target, output, {}})) {
  requireNoOutside(pusher.data_->settings.outside);
  if (!pusher.data_->densities.empty())
    throw DataError(
        "densities: their mass is summed over all of the volume, so they are not pushed in shares; "
        "push them in one run, or let them be sampled");
}

InvertedMap BlockPusher::Data::inverted(const openvdb::FloatGrid& levelSet) {
  const VolumePusher::Data& d = *pusher;
  if (d.settings.through) return invertThrough(*d.settings.through, d.regionOf(levelSet));
  const InverseSettings inverse = inverseSettings(d.settings);
  if (!images) images = imagesOf(map, d.source, d.lattice, levelSet.transform(), inverse);
  return invertBlock(map, d.source, d.lattice, *images, levelSet, inverse);
}

GridBlock BlockPusher::push(const openvdb::Coord& origin) const {
  const VolumePusher::Data& d = *data_->pusher;
  const openvdb::FloatGrid::Ptr levelSet = makeLevelSetBlock(data_->target, data_->output, origin);
  const InvertedMap inverted = data_->inverted(*levelSet);
  const CarryOutput output(d.sampled, *inverted.region, *levelSet);
  d.carrySampled(inverted, output);
  std::vector<BlockFigures> figures = resamplingOf(inverted, *levelSet, d.grids);
  figuresAt(origin, figures).inverse = inverted.statistics;
  return {output.blockGrids(), totalsOf(sumsOf(figures.front()))};
}

PushResult BlockPusher::join(std::vector<GridBlock> blocks) const {
  const VolumePusher::Data& d = *data_->pusher;
  const openvdb::FloatGrid::Ptr nothing = emptyLevelSet(data_->target, data_->output);
  GridBlocks all(std::move(blocks), nothing->transformPtr(), kCarryNumbers);
  CarryOutput output(d.sampled, *d.regionOf(*nothing), *nothing);
  output.take(all);
  const CarryFigures figures = sumOf(all, voxelsOf(d.grids, nothing->voxelSize()[0]));
  if (!d.settings.through) requireInverted(figures.inverse);
  PushResult out = d.result(figures);
  d.finish(data_->map, output, out.grids);
  noteOutside(out.grids, d.settings.outside);
  return out;
}

FramePusher::FramePusher(const FrameFitter& fitter, const openvdb::GridPtrVec& grids,
                         const FramePushSettings& settings)
    : fitter_(fitter), grids_(grids), settings_(settings) {
  settings_.output = onLatticeOf(fitter.solid(), settings.output);
  if (!settings.fadeToFitted) pusher_.emplace(pusherFor({}));
}

VolumePusher FramePusher::pusherFor(const Points& moved) const {
  PushSettings push = settings_.push;
  if (settings_.fadeToFitted)
    push.outside.fadeTo = bestRigidMotion(fitter_.solid().repaired().mesh.vertices, moved);
  return VolumePusher(fitter_.solid(), grids_, push);
}

FramePush FramePusher::push(const NumberedFit& frame,
                            const std::vector<CarriedField>& fields) const {
  const FrameFit& fit = *frame.fit;
  FramePush out;
  const openvdb::FloatGrid::Ptr target = timed(out.seconds, "level set", [&] {
    SolidSettings solid;
    const std::string name = fmt::format("frame {}", frame.number);
    return makeLevelSet(Solid(fit.boundary.mesh(fitter_.solid(), name), solid), settings_.output);
  });
  out.result = timed(out.seconds, "push", [&] {
    const VolumePusher pusher = pusher_ ? *pusher_ : pusherFor(fit.boundary.moved);
    return pusher.push(HarmonicMap(fit.field), *target, fields);
  });
  describeFrame(out.result.grids, frame);
  return out;
}

}  // namespace innermap
