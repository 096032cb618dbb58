#include "innermap/transfer/push.h"

#include <fmt/format.h>

#include <cmath>

#include "innermap/core/parallel.h"
#include "innermap/evaluate/evaluate_map.h"
#include "innermap/evaluate/map_grids.h"
#include "innermap/transfer/detail/carry_output.h"
#include "innermap/transfer/detail/extended_map.h"
#include "innermap/transfer/detail/field_grid.h"
#include "innermap/transfer/detail/source_lattice.h"

namespace innermap {
namespace {

InverseSettings inverseSettings(const PushSettings& s) {
  InverseSettings out;
  out.outside = s.outside;
  out.skin = s.skin;
  out.tolerance = s.tolerance;
  out.accuracy = s.accuracy;
  out.maxMemory = s.maxMemory;
  out.progress = s.progress;
  return out;
}

double massOf(const openvdb::GridBase& grid) {
  const auto sum = [](const auto& typed) {
    double total = 0;
    for (auto value = typed.cbeginValueOn(); value; ++value)
      total += static_cast<double>(*value) * static_cast<double>(value.getVoxelCount());
    return total * std::abs(typed.transform().baseMap()->determinant());
  };
  if (grid.isType<openvdb::FloatGrid>()) return sum(static_cast<const openvdb::FloatGrid&>(grid));
  return sum(static_cast<const openvdb::DoubleGrid&>(grid));
}

}  // namespace

struct VolumePusher::Data {
  Solid source;
  openvdb::GridPtrVec grids;
  PushSettings settings;
  SourceLattice lattice;
  Carriers carriers;
  std::vector<std::string> warnings;

  openvdb::GridPtrVec carry(const ComposedMap& map, const InvertedMap& inverted) const;
};

VolumePusher::VolumePusher(const Solid& source, const openvdb::GridPtrVec& grids,
                           const PushSettings& settings) {
  auto data = std::make_shared<Data>(Data{source, grids, settings, {}, {}, {}});
  data->lattice =
      makeSourceLattice(source, settings.outside, grids, settings.maxMemory, settings.progress);
  if (!grids.empty() && !(settings.outside.distance > 0))
    requireMeeting(grids, *data->lattice.levelSet, source.surface().name, data->warnings,
                   settings.progress);
  data->carriers =
      makeCarriers(grids, settings.carry, data->lattice.levelSet.get(), settings.progress);
  data_ = std::move(data);
}

openvdb::GridPtrVec VolumePusher::Data::carry(const ComposedMap& map,
                                              const InvertedMap& inverted) const {
  CarryOutput output(carriers, *inverted.region);
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
            Site site{inverted.sources[i], {}};
            for (std::size_t k = 0; k < 9; ++k)
              site.derivative[k / 3][k % 3] = static_cast<double>(inverted.jacobians[i][k]);
            sites.push_back(site);
          }
          output.carry(origins[l], sites.data());
        }
      },
      settings.progress, "carrying the grids");
  const ExtendedMap extended(map, source, *lattice.levelSet, settings.outside,
                             settings.accuracy * targetExtent(map, source));
  return output.finish(
      [&](const Points& points) {
        Points out;
        for (const MapSample& s : extended.at(points, settings.progress)) out.push_back(s.image);
        return out;
      },
      settings.progress);
}

PushResult VolumePusher::push(const ComposedMap& map, const openvdb::FloatGrid& targetLevelSet,
                              const std::vector<CarriedField>& fields) const {
  const Data& d = *data_;
  const InvertedMap inverted =
      invertMap(map, d.source, d.lattice, targetLevelSet, inverseSettings(d.settings));
  PushResult out;
  out.statistics = inverted.statistics;
  out.warnings = d.warnings;
  const std::string doubt = inverted.statistics.warning();
  if (!doubt.empty()) out.warnings.push_back(doubt);
  out.grids = d.carry(map, inverted);
  for (const auto& carrier : d.carriers)
    if (carrier->isDensity()) {
      const std::size_t place = carrier->places().front();
      out.masses.push_back(
          {d.grids[place]->getName(), massOf(*d.grids[place]), massOf(*out.grids[place])});
    }
  for (const CarriedField& field : fields)
    out.grids.push_back(
        fieldGrid(field, d.source, d.lattice, inverted, d.settings.accuracy, d.settings.progress));
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
    solid.progress = settings_.push.progress;
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
