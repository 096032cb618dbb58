#include "innermap/transfer/distance_transfer.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include "evaluate/active_region.h"
#include "innermap/core/run.h"
#include "innermap/evaluate/evaluate_map.h"
#include "innermap/levelset/level_set.h"
#include "levelset/level_set_settings.h"

namespace innermap {
namespace {

using FloatLeaf = openvdb::FloatTree::LeafNodeType;

constexpr double kMargin = 1 + 1e-9;

// Distances along a way through space: each point is near the one before, which bounds its distance
// and mostly tells its side.
class DepthWalk {
 public:
  explicit DepthWalk(const Solid& solid) : solid_(solid) {}

  // Unsigned.
  double distanceAt(const Vec3& p) {
    const double step = started_ ? norm(p - last_) : 0;
    const double within = started_ ? kMargin * (distance_ + step) + 1e-12 * solid_.diagonal()
                                   : std::numeric_limits<double>::infinity();
    const Solid::Closest closest = solid_.closest(p, within);
    // Rounding may put the closest point just beyond the bound.
    const double d = closest.onSurface.triangle >= 0 ? closest.distance : solid_.distance(p);
    // The balls about two points are free of surface: where they meet, both are on the same side.
    sameSide_ = started_ && distance_ + d > kMargin * step + 2 * solid_.gap();
    started_ = true;
    last_ = p;
    distance_ = d;
    return d;
  }

  // Positive inside.
  double depthAt(const Vec3& p) {
    const double d = distanceAt(p);
    if (!sameSide_) inside_ = solid_.inside(p);
    return inside_ ? d : -d;
  }

 private:
  const Solid& solid_;
  Vec3 last_;
  double distance_ = 0;
  bool started_ = false, sameSide_ = false, inside_ = false;
};

// A grid with one float leaf for each leaf of `region`: fill(source leaf, result leaf).
template <class Grid, class Fill>
openvdb::FloatGrid::Ptr leafByLeaf(const Grid& region, const Fill& fill) {
  std::vector<const typename Grid::TreeType::LeafNodeType*> from;
  region.tree().getNodes(from);
  std::vector<std::unique_ptr<FloatLeaf>> leaves(from.size());
  parallelBlocks(
      from.size(), 8,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
          leaves[i] = std::make_unique<FloatLeaf>(from[i]->origin(), 0.0f, false);
          fill(*from[i], *leaves[i]);
        }
      },
      "distances");
  auto grid = openvdb::FloatGrid::create(0.0f);
  for (auto& leaf : leaves) grid->tree().addLeaf(leaf.release());
  grid->setTransform(region.transform().copy());
  grid->setName("distance");
  return grid;
}

Vec3 vec3(const openvdb::Vec3d& v) { return {v.x(), v.y(), v.z()}; }

SolidDepths depthsOf(const Solid& solid, const DistanceTransferSettings& settings,
                     StageSeconds& seconds) {
  const LevelSetSettings levelSet = levelSetSettings(settings);
  DepthSettings depth;
  SolidDepths out;
  timed(seconds, "voxelize", [&] { out.surface = makeLevelSet(solid, levelSet); });
  timed(seconds, "distance", [&] { out.depth = depthInside(solid, *out.surface, depth); });
  out.figures = depthFigures(*out.depth, *out.surface);
  return out;
}

}  // namespace

openvdb::FloatGrid::Ptr depthInside(const Solid& solid, const openvdb::FloatGrid& levelSet,
                                    const DepthSettings& settings) {
  RegionSettings where;
  where.skin = settings.skin;
  where.bytesPerVoxel = sizeof(float);
  const openvdb::MaskGrid::Ptr region = activeRegion(levelSet, where);
  return leafByLeaf(*region, [&](const auto& from, FloatLeaf& leaf) {
    DepthWalk walk(solid);
    const auto signs = levelSet.getConstUnsafeAccessor();
    for (auto voxel = from.cbeginValueOn(); voxel; ++voxel) {
      const openvdb::Coord at = voxel.getCoord();
      const double d = walk.distanceAt(vec3(levelSet.indexToWorld(at)));
      leaf.setValueOn(voxel.pos(), static_cast<float>(signs.getValue(at) < 0 ? d : -d));
    }
  });
}

openvdb::FloatGrid::Ptr depthThrough(const openvdb::Vec3fGrid& map, const Solid& target) {
  return leafByLeaf(map, [&](const auto& from, FloatLeaf& leaf) {
    DepthWalk walk(target);
    for (auto voxel = from.cbeginValueOn(); voxel; ++voxel)
      leaf.setValueOn(voxel.pos(), static_cast<float>(walk.depthAt(vec3(openvdb::Vec3d(*voxel)))));
  });
}

DepthFigures depthFigures(const openvdb::FloatGrid& distance, const openvdb::FloatGrid& levelSet) {
  DepthFigures out;
  const auto inside = levelSet.getConstAccessor();
  for (auto v = distance.cbeginValueOn(); v; ++v) {
    if (!(inside.getValue(v.getCoord()) < 0)) continue;
    ++out.voxels;
    out.negative += *v < 0;
    out.largest = std::max(out.largest, static_cast<double>(*v));
  }
  return out;
}

DistanceTransfer transferDistance(const ComposedMap& map, const Solid& source, const Solid& target,
                                  const DistanceTransferSettings& settings) {
  DistanceTransfer out;
  out.target = depthsOf(target, settings, out.seconds);
  out.source = depthsOf(source, settings, out.seconds);
  out.source.depth->setName("source_distance");
  EvaluateSettings evaluate;
  evaluate.jacobian = evaluate.harmonicEnergy = evaluate.deformationEnergy = false;
  evaluate.accuracy = settings.accuracy;
  MapGrids grids;
  timed(out.seconds, "evaluate",
        [&] { grids = evaluateMap(map, source, *out.source.surface, evaluate); });
  requireInterior(grids.interiorVoxels, source, "the source");
  timed(out.seconds, "transfer", [&] { out.through = depthThrough(*grids.map, target); });
  out.throughFigures = depthFigures(*out.through, *out.source.surface);
  out.outsideFraction = static_cast<double>(out.throughFigures.negative) /
                        std::max<double>(1, static_cast<double>(out.throughFigures.voxels));
  return out;
}

std::uint64_t distanceTransferMemory(const Solid& source, const Solid& target,
                                     const DistanceTransferSettings& settings) {
  // Of a voxel of the source: its depth, its image, the depth of that; and masks. Leaves of 8^3
  // voxels are allocated whole, along the surface some 6 voxels to either side.
  constexpr double kSource = 20.6, kTarget = 4.2, kReach = 12, kOther = 20e6;
  const LevelSetSettings levelSet = levelSetSettings(settings);
  const auto need = [&](const Solid& solid, double bytes) {
    const double voxel = voxelSizeFor(solid, levelSet);
    return static_cast<double>(levelSetMemory(solid, levelSet)) +
           bytes * (solid.volume() / std::pow(voxel, 3) + kReach * solid.area() / (voxel * voxel));
  };
  return static_cast<std::uint64_t>(need(source, kSource) + need(target, kTarget) + kOther);
}

}  // namespace innermap
