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
#include "innermap/mesh/mesh.h"
#include "transfer/detail/field_grid.h"
#include "transfer/detail/volume_pusher.h"

namespace innermap {

InverseSettings inverseSettings(const PushSettings& s) {
  InverseSettings out;
  out.outside = s.outside;
  out.skin = s.skin;
  out.tolerance = s.tolerance;
  out.accuracy = s.accuracy;
  return out;
}

double meanGrowth(const SolidMap& map, const Solid& source, double accuracy) {
  const Mesh& mesh = source.repaired().mesh;
  const Points moved = map.images(mesh.vertices, accuracy * map.targetDiagonal(source));
  return std::cbrt(
      volumeRatio(std::abs(signedVolume(mesh)), std::abs(signedVolume(moved, mesh.triangles))));
}

CarryDensitySettings densitySettings(const openvdb::GridBase& density, double grown, double to,
                                     const CarrySettings& carry) {
  constexpr double kLarger = 0.75;  // than the target's voxels, at most
  constexpr double kMost = 32;
  const openvdb::Vec3d voxel = density.voxelSize();
  const double ratio = std::max({voxel.x(), voxel.y(), voxel.z()}) * grown / to;
  CarryDensitySettings out;
  out.parts = static_cast<int>(std::clamp(ratio + 1 - kLarger, 1.0, kMost));
  out.limit = carry.densityLimit;
  out.constant = carry.sampling == Sampling::nearest;
  return out;
}

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

ExtendedMap VolumePusher::Data::extended(const SolidMap& map) const {
  return {map, source, *lattice.levelSet, settings.outside,
          settings.accuracy * map.targetDiagonal(source)};
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

void VolumePusher::Data::finish(const SolidMap& map, CarryOutput& output,
                                openvdb::GridPtrVec& out) const {
  output.finish(
      [&](const Points& points) {
        Points images;
        for (const PointImage& s : extended(map).at(points)) images.push_back(s.image);
        return images;
      },
      out);
}

void VolumePusher::Data::carryDensities(const SolidMap& map, const openvdb::MaskGrid& region,
                                        PushResult& out) const {
  if (densities.empty()) return;
  const ExtendedMap extendedMap = extended(map);
  const double grown = meanGrowth(map, source, settings.accuracy);
  for (const auto& [place, voxels] : densities) {
    out.masses.emplace_back();
    out.grids[place] =
        carryDensity(voxels, extendedMap, region, out.masses.back(),
                     densitySettings(*voxels.grid, grown, region.voxelSize()[0], settings.carry));
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

PushResult VolumePusher::Data::uninverted(std::uint64_t voxels) const {
  PushResult out;
  out.warnings = warnings;
  out.grids.resize(grids.size());
  out.statistics.voxels = voxels;
  return out;
}

PushResult VolumePusher::push(const SolidMap& map, const openvdb::FloatGrid& targetLevelSet,
                              const std::vector<CarriedField>& fields) const {
  const Data& d = *data_;
  PushResult out;
  openvdb::MaskGrid::Ptr region;
  if (d.sampled.empty() && fields.empty()) {
    region = d.regionOf(targetLevelSet);
    out = d.uninverted(region->activeVoxelCount());
  } else {
    const InvertedMap inverted =
        invertMap(map, d.source, d.lattice, targetLevelSet, inverseSettings(d.settings));
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
  d.carryDensities(map, *region, out);
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
