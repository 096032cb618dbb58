#include "innermap/evaluate/evaluate_map.h"

#include <openvdb/tree/LeafManager.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "innermap/core/error.h"
#include "innermap/core/parallel.h"
#include "innermap/evaluate/active_region.h"
#include "innermap/levelset/level_set.h"

namespace innermap {
namespace {

using FloatLeaf = openvdb::FloatTree::LeafNodeType;
using Vec3Leaf = openvdb::Vec3STree::LeafNodeType;

// What one leaf adds to the totals; summed in the leaves' order so that the sums do not depend on
// the threads.
struct LeafTotals {
  double harmonic = 0, deformation = 0, volume = 0, folded = 0;
  double jacobianMin = std::numeric_limits<double>::infinity(), jacobianMax = -jacobianMin;
  std::uint64_t active = 0, interior = 0;
};

// The voxels of one leaf: where the map is evaluated, and what to make of it.
struct LeafPoints {
  std::vector<openvdb::Index> offsets;
  Points evaluated;  // the voxel's centre, or its closest boundary point when it is outside
  Points beyond;     // from there to the voxel's centre
  std::vector<double> share;  // of the cell inside the solid, 0..1
  std::vector<bool> inside;
};

Vec3 toVec3(const openvdb::Vec3d& v) { return {v.x(), v.y(), v.z()}; }

class Evaluation {
 public:
  Evaluation(const HarmonicMap& map, const Solid& solid, const openvdb::FloatGrid& levelSet,
             const EvaluateSettings& settings)
      : map_(map), solid_(solid), levelSet_(levelSet), settings_(settings) {
    voxel_ = levelSet.voxelSize()[0];
    const double target = settings.targetVolume > 0 ? settings.targetVolume : solid.volume();
    unitVolumeScale_ = std::pow(solid.volume() / target, 2.0 / 3);
  }

  MapGrids run();

 private:
  LeafPoints collect(const openvdb::MaskTree::LeafNodeType& leaf) const;
  LeafTotals evaluateLeaf(const openvdb::MaskTree::LeafNodeType& leaf, MapGrids& out) const;

  const HarmonicMap& map_;
  const Solid& solid_;
  const openvdb::FloatGrid& levelSet_;
  const EvaluateSettings& settings_;
  double voxel_ = 0, unitVolumeScale_ = 1;
};

LeafPoints Evaluation::collect(const openvdb::MaskTree::LeafNodeType& leaf) const {
  LeafPoints out;
  auto distances = levelSet_.getConstAccessor();
  for (auto voxel = leaf.cbeginValueOn(); voxel; ++voxel) {
    const openvdb::Coord ijk = voxel.getCoord();
    const Vec3 center = toVec3(levelSet_.transform().indexToWorld(ijk));
    const double distance = distances.getValue(ijk);
    out.offsets.push_back(voxel.pos());
    out.inside.push_back(distance < 0);
    double share = distance < 0 ? 1 : 0;
    Vec3 at = center;
    // Where the surface may pass through the cell (half its diagonal), or the voxel is outside.
    if (distance > -0.87 * voxel_) {
      const Solid::Closest closest = solid_.closest(center, 4 * voxel_);
      if (closest.onSurface.triangle >= 0) {
        if (distance >= 0) at = closest.position;
        const Vec3 away = (distance < 0 ? -1.0 : 1.0) * (center - closest.position);
        const double length = norm(away);
        if (length > 1e-12 * voxel_)
          share = cellFraction((distance < 0 ? -length : length) / voxel_, away / length);
        else
          share = 0.5;
      }
    }
    out.share.push_back(share);
    out.evaluated.push_back(at);
    out.beyond.push_back(center - at);
  }
  return out;
}

LeafTotals Evaluation::evaluateLeaf(const openvdb::MaskTree::LeafNodeType& leaf,
                                    MapGrids& out) const {
  const LeafPoints points = collect(leaf);
  const std::size_t n = points.evaluated.size();
  Points positions(n);
  std::vector<Mat3> jacobians(n);
  map_.evaluate(points.evaluated.data(), n, positions.data(), jacobians.data());

  const openvdb::Coord origin = leaf.origin();
  Vec3Leaf* map = out.map ? out.map->tree().probeLeaf(origin) : nullptr;
  FloatLeaf* jacobian = out.jacobian ? out.jacobian->tree().probeLeaf(origin) : nullptr;
  FloatLeaf* harmonic = out.harmonicEnergy ? out.harmonicEnergy->tree().probeLeaf(origin) : nullptr;
  FloatLeaf* deformation =
      out.deformationEnergy ? out.deformationEnergy->tree().probeLeaf(origin) : nullptr;

  LeafTotals totals;
  for (std::size_t i = 0; i < n; ++i) {
    const Mat3& j = jacobians[i];
    const Vec3 d = points.beyond[i];
    Vec3 q = positions[i];
    for (int r = 0; r < 3; ++r) q[r] += dot(Vec3{j[r][0], j[r][1], j[r][2]}, d);
    const double det = determinant(j);
    const double h = unitVolumeScale_ * harmonicEnergyDensity(j);
    const double psi = deformationEnergyDensity(j, settings_.lame);
    const openvdb::Index at = points.offsets[i];
    if (map) map->setValueOnly(at, openvdb::Vec3f(openvdb::Vec3d(q.x, q.y, q.z)));
    if (jacobian) jacobian->setValueOnly(at, static_cast<float>(det));
    if (harmonic) harmonic->setValueOnly(at, static_cast<float>(h));
    if (deformation) deformation->setValueOnly(at, static_cast<float>(psi));

    const double share = points.share[i];
    totals.volume += share;
    totals.harmonic += share * h;
    totals.deformation += share * psi;
    if (det <= 0) totals.folded += share;
    ++totals.active;
    if (!points.inside[i]) continue;
    ++totals.interior;
    totals.jacobianMin = std::min(totals.jacobianMin, det);
    totals.jacobianMax = std::max(totals.jacobianMax, det);
  }
  return totals;
}

template <class Grid>
typename Grid::Ptr gridLike(const openvdb::MaskGrid& region, const char* name) {
  auto grid = Grid::create();
  grid->setTree(std::make_shared<typename Grid::TreeType>(
      region.tree(), typename Grid::ValueType(0), openvdb::TopologyCopy()));
  grid->setTransform(region.transform().copy());
  grid->setName(name);
  return grid;
}

MapGrids Evaluation::run() {
  constexpr std::uint64_t kMaskBytes = 1;
  const std::uint64_t bytes = kMaskBytes + (settings_.map ? 12 : 0) + (settings_.jacobian ? 4 : 0) +
                              (settings_.harmonicEnergy ? 4 : 0) +
                              (settings_.deformationEnergy ? 4 : 0);
  const openvdb::MaskGrid::Ptr region =
      activeRegion(levelSet_, settings_.skin, bytes, settings_.maxMemory, settings_.progress);
  MapGrids out;
  if (settings_.map) {
    out.map = gridLike<openvdb::Vec3fGrid>(*region, "map");
    out.map->setVectorType(openvdb::VEC_INVARIANT);
  }
  if (settings_.jacobian) out.jacobian = gridLike<openvdb::FloatGrid>(*region, "jacobian");
  if (settings_.harmonicEnergy)
    out.harmonicEnergy = gridLike<openvdb::FloatGrid>(*region, "harmonic_energy");
  if (settings_.deformationEnergy)
    out.deformationEnergy = gridLike<openvdb::FloatGrid>(*region, "deformation_energy");

  const openvdb::tree::LeafManager<const openvdb::MaskTree> leaves(region->tree());
  std::vector<LeafTotals> totals(leaves.leafCount());
  parallelBlocks(
      leaves.leafCount(), 1,
      [&](std::size_t begin, std::size_t) {
        totals[begin] = evaluateLeaf(leaves.leaf(begin), out);
      },
      settings_.progress, "evaluating the map");

  LeafTotals sum;
  for (const LeafTotals& t : totals) {
    sum.harmonic += t.harmonic;
    sum.deformation += t.deformation;
    sum.volume += t.volume;
    sum.folded += t.folded;
    sum.active += t.active;
    sum.interior += t.interior;
    sum.jacobianMin = std::min(sum.jacobianMin, t.jacobianMin);
    sum.jacobianMax = std::max(sum.jacobianMax, t.jacobianMax);
  }
  const double cell = voxel_ * voxel_ * voxel_;
  out.volume = sum.volume * cell;
  out.harmonicTotal = sum.harmonic * cell / solid_.volume();
  out.deformationTotal = sum.deformation * cell;
  out.foldedFraction = sum.volume > 0 ? sum.folded / sum.volume : 0;
  out.jacobianMin = sum.interior ? sum.jacobianMin : 0;
  out.jacobianMax = sum.interior ? sum.jacobianMax : 0;
  out.activeVoxels = sum.active;
  out.interiorVoxels = sum.interior;
  return out;
}

}  // namespace

std::vector<openvdb::GridBase::Ptr> MapGrids::all() const {
  std::vector<openvdb::GridBase::Ptr> grids;
  for (const openvdb::GridBase::Ptr& grid :
       {openvdb::GridBase::Ptr(map), openvdb::GridBase::Ptr(jacobian),
        openvdb::GridBase::Ptr(harmonicEnergy), openvdb::GridBase::Ptr(deformationEnergy)})
    if (grid) grids.push_back(grid);
  return grids;
}

MapGrids evaluateMap(const HarmonicMap& map, const Solid& solid, const openvdb::FloatGrid& levelSet,
                     const EvaluateSettings& settings) {
  if (!(settings.lame.lambda >= 0) || !(settings.lame.mu >= 0))
    throw SettingError("Lame constants", "must not be negative");
  if (!(settings.skin >= 0 && settings.skin <= 3))
    throw SettingError("skin", "must lie in [0, 3] voxels");
  if (!(settings.targetVolume >= 0)) throw SettingError("target volume", "must not be negative");
  return Evaluation(map, solid, levelSet, settings).run();
}

}  // namespace innermap
