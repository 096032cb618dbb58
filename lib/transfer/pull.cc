#include "core/require_number.h"
#include "evaluate/active_region.h"
#include "innermap/core/error.h"
#include "innermap/evaluate/evaluate_map.h"
#include "innermap/transfer/inverse_map.h"
#include "innermap/transfer/push_pull.h"
#include "transfer/detail/carry_output.h"
#include "transfer/detail/extended_map.h"
#include "transfer/detail/source_lattice.h"

namespace innermap {
namespace {

class Pull {
 public:
  Pull(const ComposedMap& map, const Solid& source, const openvdb::FloatGrid& levelSet,
       const PullSettings& settings)
      : settings_(settings),
        map_(map, source, levelSet, settings.outside,
             settings.accuracy * targetExtent(map, source)) {}

  PullResult run(const openvdb::GridPtrVec& grids);

 private:
  openvdb::MaskGrid::Ptr region(const openvdb::GridPtrVec& grids) const;
  Points movedBack(const Points& positions) const;
  void carryThrough(const openvdb::MaskGrid& region, CarryOutput& output) const;

  ResamplingFigures carryByMap(const openvdb::MaskGrid& region, const openvdb::GridPtrVec& grids,
                               const CarryOutput& output);

  const PullSettings& settings_;
  ExtendedMap map_;
};

// Of the source's solid, and what is around it as far as the map is extended.
openvdb::MaskGrid::Ptr Pull::region(const openvdb::GridPtrVec& grids) const {
  RegionSettings inside;
  inside.skin = settings_.skin;
  inside.bytesPerVoxel = outputBytesPerVoxel(grids);
  openvdb::MaskGrid::Ptr region = activeRegion(map_.levelSet(), inside);
  if (!(settings_.outside.distance > 0)) return region;
  addAround(*region, map_.solid(), map_.reach(), outputBytesPerVoxel(grids) + 16);
  return region;
}

// The inverse map at positions of the target, found only when a grid holds positions.
Points Pull::movedBack(const Points& positions) const {
  if (settings_.through) {
    Points images;
    std::vector<Mat3> jacobians;
    settings_.through->pull(positions, images, jacobians);
    return images;
  }
  if (!settings_.targetLevelSet)
    throw DataError(
        "pull: positions (contravariant absolute vectors) need the "
        "target's level set");
  const SourceLattice lattice = makeSourceLattice(map_.solid(), {}, {});
  InverseSettings inverse;
  inverse.accuracy = settings_.accuracy;
  const InvertedMap inverted =
      invertMap(map_.map(), map_.solid(), lattice, *settings_.targetLevelSet, inverse);
  return invertAt(map_.map(), map_.solid(), lattice, inverted, positions, inverse);
}

void Pull::carryThrough(const openvdb::MaskGrid& region, CarryOutput& output) const {
  forLeavesThrough(region, settings_.through->push,
                   [&](std::size_t, const openvdb::Coord& origin, const Points& images,
                       const std::vector<Mat3>& jacobians) {
                     std::vector<Site> sites;
                     for (std::size_t i = 0; i < images.size(); ++i)
                       sites.push_back({images[i], images[i], inverse(jacobians[i])});
                     output.carry(origin, sites.data());
                   });
}

ResamplingFigures Pull::carryByMap(const openvdb::MaskGrid& region,
                                   const openvdb::GridPtrVec& grids, const CarryOutput& output) {
  ResamplingFigures all;
  all.inputVoxel = finestVoxel(grids);
  all.outputVoxel = map_.levelSet().voxelSize()[0];
  std::vector<ResamplingFigures> parts(region.tree().leafCount(), all);
  map_.visit(
      region,
      [&](std::size_t number, const LeafValues& leaf, const std::vector<ExtendedSample>& samples) {
        std::vector<Site> sites;
        for (std::size_t i = 0; i < samples.size(); ++i) {
          const ExtendedSample& s = samples[i];
          sites.push_back({s.image, s.image, inverse(s.jacobian)});
          if (leaf.inside[i]) parts[number].add(1 / determinant(s.jacobian));
        }
        output.carry(leaf.origin, sites.data());
      },
      "pulling the grids");
  for (const ResamplingFigures& part : parts) all.add(part);
  all.finish();
  return all;
}

PullResult Pull::run(const openvdb::GridPtrVec& grids) {
  PullResult out;
  if (settings_.targetLevelSet && !(settings_.outside.distance > 0))
    requireMeeting(grids, *settings_.targetLevelSet, "of the map's target", out.warnings);
  const Carriers carriers = makeCarriers(grids, settings_.carry, settings_.targetLevelSet);
  const openvdb::MaskGrid::Ptr active = region(grids);
  CarryOutput output(carriers, *active, map_.levelSet());
  if (settings_.through)
    carryThrough(*active, output);
  else
    out.resampling = carryByMap(*active, grids, output);
  out.grids.resize(grids.size());
  output.finish([&](const Points& points) { return movedBack(points); }, out.grids);
  noteOutside(out.grids, settings_.outside);
  out.voxels = active->activeVoxelCount();
  return out;
}

}  // namespace

PullResult pullGrids(const ComposedMap& map, const Solid& source,
                     const openvdb::FloatGrid& levelSet, const openvdb::GridPtrVec& grids,
                     const PullSettings& settings) {
  requireNumber("accuracy", settings.accuracy, {1e-12, 1e-3}, "of the target's extent");
  return Pull(map, source, levelSet, settings).run(grids);
}

}  // namespace innermap
