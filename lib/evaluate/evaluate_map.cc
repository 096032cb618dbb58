#include "innermap/evaluate/evaluate_map.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "core/require_number.h"
#include "evaluate/active_region.h"
#include "evaluate/detail/fold_repair.h"
#include "evaluate/detail/map_values.h"
#include "evaluate/topology.h"
#include "evaluate/visit_field.h"
#include "innermap/core/run.h"

namespace innermap {
namespace {

constexpr double kMoving = 0.9;  // of repairing folds; then what was moved is evaluated again

using FloatLeaf = openvdb::FloatTree::LeafNodeType;
using Vec3Leaf = openvdb::Vec3STree::LeafNodeType;

// Where the leaves' values go.
struct LeafOutput {
  Vec3Leaf* map = nullptr;
  FloatLeaf *jacobian = nullptr, *harmonic = nullptr, *deformation = nullptr;

  LeafOutput(const MapGrids& grids, const openvdb::Coord& origin) {
    if (grids.map) map = grids.map->tree().probeLeaf(origin);
    if (grids.jacobian) jacobian = grids.jacobian->tree().probeLeaf(origin);
    if (grids.harmonicEnergy) harmonic = grids.harmonicEnergy->tree().probeLeaf(origin);
    if (grids.deformationEnergy) deformation = grids.deformationEnergy->tree().probeLeaf(origin);
  }
};

bool mayRepair(const EvaluateSettings& settings) { return settings.repairUpTo > 0; }

// With the grids that repairing takes.
EvaluateSettings withRepaired(const EvaluateSettings& settings) {
  EvaluateSettings out = settings;
  out.map = out.map || mayRepair(settings);
  out.jacobian = out.jacobian || mayRepair(settings);
  return out;
}

class Evaluation {
 public:
  Evaluation(const ComposedMap& map, const Solid& solid, const openvdb::FloatGrid& levelSet,
             const EvaluateSettings& settings)
      : map_(map), solid_(solid), levelSet_(levelSet), settings_(settings) {
    voxel_ = levelSet.voxelSize()[0];
    const double target = settings.targetVolume > 0 ? settings.targetVolume : solid.volume();
    unitVolumeScale_ = std::pow(solid.volume() / target, 2.0 / 3);
    accuracy_ = settings.accuracy * targetExtent(map, solid);
  }

  MapValues values(const FieldRegion& region) const;
  MapGrids conclude(MapValues values) const;

 private:
  using LeafTotals = std::map<openvdb::Coord, MapTotals>;

  bool isFolded(double det) const { return !((settings_.mirrored ? -det : det) > 0); }
  void markFolds(MapGrids& out) const;
  void repair(MapValues& values) const;
  LeafTotals leavesOf(const std::set<openvdb::Coord>& blocks, const MapValues& values) const;
  MapTotals store(const LeafValues& values, const MapGrids& out) const;
  void store(const Mat3& j, const Vec3& position, double share, std::size_t offset,
             const LeafOutput& out, MapTotals& totals) const;

  const ComposedMap& map_;
  const Solid& solid_;
  const openvdb::FloatGrid& levelSet_;
  const EvaluateSettings& settings_;
  double voxel_ = 0, unitVolumeScale_ = 1;
  double accuracy_ = 0;  // of sums, world units of the target
};

void Evaluation::store(const Mat3& j, const Vec3& position, double share, std::size_t offset,
                       const LeafOutput& out, MapTotals& totals) const {
  const double det = determinant(j), h = unitVolumeScale_ * harmonicEnergyDensity(j),
               psi = deformationEnergyDensity(j, settings_.lame);
  const auto at = static_cast<openvdb::Index>(offset);
  const openvdb::Vec3d exact(position.x, position.y, position.z);
  if (out.map)
    out.map->setValueOnly(
        at, openvdb::Vec3f(exact - openvdb::Vec3d(settings_.origin.x, settings_.origin.y,
                                                  settings_.origin.z)));
  totals.rounding =
      std::max(totals.rounding, (openvdb::Vec3d(openvdb::Vec3f(exact)) - exact).length());
  if (out.jacobian) out.jacobian->setValueOnly(at, static_cast<float>(det));
  if (out.harmonic) out.harmonic->setValueOnly(at, static_cast<float>(h));
  if (out.deformation) out.deformation->setValueOnly(at, static_cast<float>(psi));
  totals.volume += share;
  totals.harmonic += share * h;
  totals.deformation += share * psi;
  if (isFolded(det)) totals.folded += share;
  ++totals.active;
}

MapTotals Evaluation::store(const LeafValues& values, const MapGrids& out) const {
  const LeafOutput leaf(out, values.origin);
  MapTotals totals;
  for (std::size_t i = 0; i < values.count; ++i) {
    Mat3 j;
    for (std::size_t r = 0; r < 3; ++r)
      for (std::size_t a = 0; a < 3; ++a) j[r][a] = values.gradients[9 * i + 3 * r + a];
    const double* q = values.values + 3 * i;
    store(j, {q[0], q[1], q[2]}, values.share[i], values.offset[i], leaf, totals);
    if (!values.inside[i]) continue;
    const double det = determinant(j);
    ++totals.interior;
    if (isFolded(det)) ++totals.foldedVoxels;
    totals.jacobianMin = std::min(totals.jacobianMin, det);
    totals.jacobianMax = std::max(totals.jacobianMax, det);
  }
  return totals;
}

template <class GridPtr>
GridPtr named(GridPtr grid, const char* name) {
  grid->setName(name);
  return grid;
}

void Evaluation::markFolds(MapGrids& out) const {
  out.folded = named(openvdb::FloatGrid::create(), "folded");
  out.folded->setTransform(out.jacobian->transform().copy());
  auto marks = out.folded->getAccessor();
  const auto distance = levelSet_.getConstAccessor();
  for (auto voxel = out.jacobian->cbeginValueOn(); voxel; ++voxel)
    if (isFolded(*voxel) && distance.getValue(voxel.getCoord()) < 0)
      marks.setValue(voxel.getCoord(), 1.0f);
}

// The values of a leaf with those of repaired voxels in their places.
class RepairedLeaf {
 public:
  RepairedLeaf(const LeafValues& leaf, const FoldRepair& repair, const Vec3& origin)
      : leaf_(leaf),
        values_(leaf.values, leaf.values + 3 * leaf.count),
        gradients_(leaf.gradients, leaf.gradients + 9 * leaf.count) {
    for (std::size_t i = 0; i < leaf.count; ++i) {
      const auto local = openvdb::MaskTree::LeafNodeType::offsetToLocalCoord(leaf.offset[i]);
      const auto found = repair.voxels.find(leaf.origin + local);
      if (found == repair.voxels.end()) continue;
      for (std::size_t r = 0; r < 3; ++r) {
        const int axis = static_cast<int>(r);
        values_[3 * i + r] = origin[axis] + found->second.position[axis];
        for (std::size_t a = 0; a < 3; ++a)
          gradients_[9 * i + 3 * r + a] = found->second.jacobian[r][a];
      }
    }
    leaf_.values = values_.data();
    leaf_.gradients = gradients_.data();
  }

  const LeafValues& leaf() const { return leaf_; }

 private:
  LeafValues leaf_;
  std::vector<double> values_, gradients_;
};

// A mask without voxels, on the lattice of a grid.
openvdb::MaskGrid::Ptr maskLike(const openvdb::GridBase& grid) {
  const openvdb::MaskGrid::Ptr mask = openvdb::MaskGrid::create();
  mask->setTransform(grid.transform().copy());
  return mask;
}

void addLeaf(const MapGrids& grids, const openvdb::Coord& at, openvdb::MaskGrid& region) {
  region.tree().touchLeaf(at)->topologyUnion(*grids.map->tree().probeConstLeaf(at));
}

// What was summed for the leaves of these blocks. Where others made the values they are made again,
// to the same bits.
Evaluation::LeafTotals Evaluation::leavesOf(const std::set<openvdb::Coord>& blocks,
                                            const MapValues& values) const {
  LeafTotals leaves;
  for (const auto& [origin, totals] : values.leaves)
    if (blocks.count(blockOf(origin)) > 0) leaves.emplace(origin, totals);
  if (!values.leaves.empty()) return leaves;
  const openvdb::MaskGrid::Ptr region = maskLike(*values.grids.map);
  for (auto leaf = values.grids.map->tree().cbeginLeaf(); leaf; ++leaf)
    if (blocks.count(blockOf(leaf->origin())) > 0) addLeaf(values.grids, leaf->origin(), *region);
  const FieldRegion where(solid_, levelSet_, *region);
  for (std::size_t l = 0; l < where.leafCount(); ++l) leaves.emplace(where.origin(l), MapTotals());
  visitField(map_, where,
             [&](std::size_t, const LeafValues& found) {
               leaves.at(found.origin) = store(found, values.grids);
             },
             {accuracy_, kRepairing});
  return leaves;
}

// The leaves are evaluated once more where a voxel was moved: the grids hold floats.
void Evaluation::repair(MapValues& values) const {
  MapGrids& out = values.grids;
  FoldRepairSettings s;
  s.growth = std::pow(unitVolumeScale_, -0.5);
  s.mirrored = settings_.mirrored;
  const FoldRepair repair = [&] {
    const PartOfStage moving(0, kMoving);
    reportProgress(kRepairing, 0);
    return repairFolds(*out.map, *out.jacobian, levelSet_, s);
  }();
  if (repair.voxels.empty() && out.foldedVoxels == 0) return;
  out.repairedFarthest = repair.farthest;
  out.repaired = named(openvdb::FloatGrid::create(), "repaired");
  out.repaired->setTransform(out.map->transform().copy());
  auto ways = out.repaired->getAccessor();
  const openvdb::MaskGrid::Ptr again = maskLike(*out.map);
  std::set<openvdb::Coord> blocks;
  const auto before = out.map->getConstAccessor();
  for (const auto& [at, voxel] : repair.voxels) {
    const openvdb::Vec3f p = before.getValue(at);
    ways.setValue(at, static_cast<float>(norm(voxel.position - Vec3{p.x(), p.y(), p.z()})));
    addLeaf(out, at, *again);
    blocks.insert(blockOf(at));
  }
  const PartOfStage evaluating(kMoving, 1);
  LeafTotals leaves = leavesOf(blocks, values);
  visitField(map_, FieldRegion(solid_, levelSet_, *again),
             [&](std::size_t, const LeafValues& found) {
               leaves.at(found.origin) =
                   store(RepairedLeaf(found, repair, settings_.origin).leaf(), out);
             },
             {accuracy_, kRepairing});
  for (BlockTotals& b : values.blocks) {
    if (blocks.count(b.block) == 0) continue;
    b.totals = {};
    for (const auto& [origin, totals] : leaves)
      if (blockOf(origin) == b.block) b.totals.add(totals);
  }
}

MapValues Evaluation::values(const FieldRegion& region) const {
  MapValues out;
  MapGrids& grids = out.grids = mapGridsOn(region.mask(), withRepaired(settings_));
  for (std::size_t l = 0; l < region.leafCount(); ++l)
    out.leaves.emplace_back(region.origin(l), MapTotals());
  visitField(map_, region,
             [&](std::size_t leaf, const LeafValues& values) {
               out.leaves[leaf].second = store(values, grids);
             },
             {accuracy_, "evaluating the map"});
  for (const auto& [origin, totals] : out.leaves) {
    if (out.blocks.empty() || out.blocks.back().block != blockOf(origin))
      out.blocks.push_back({blockOf(origin), {}});
    out.blocks.back().totals.add(totals);
  }
  return out;
}

MapGrids Evaluation::conclude(MapValues values) const {
  MapGrids& out = values.grids;
  std::sort(values.blocks.begin(), values.blocks.end(),
            [](const BlockTotals& a, const BlockTotals& b) { return a.block < b.block; });
  std::uint64_t interior = 0;
  for (const BlockTotals& b : values.blocks) {
    out.foldedVoxels += b.totals.foldedVoxels;
    interior += b.totals.interior;
  }
  if (out.jacobian && out.foldedVoxels > 0) markFolds(out);
  const double most = settings_.repairUpTo * static_cast<double>(interior);
  if (mayRepair(settings_) && static_cast<double>(out.foldedVoxels) <= most) repair(values);
  if (!settings_.map) out.map.reset();
  if (!settings_.jacobian) {
    out.jacobian.reset();
    out.folded.reset();
  }
  MapTotals sum;
  for (const BlockTotals& b : values.blocks) sum.add(b.totals);
  const double cell = voxel_ * voxel_ * voxel_;
  out.volume = sum.volume * cell;
  // By the volume that the voxels sum to, so that a rigid map has 3 at every resolution.
  out.harmonicTotal = sum.volume > 0 ? sum.harmonic / sum.volume : 0;
  out.deformationTotal = sum.deformation * cell;
  out.foldedFraction = sum.volume > 0 ? sum.folded / sum.volume : 0;
  out.jacobianMin = sum.interior ? sum.jacobianMin : 0;
  out.jacobianMax = sum.interior ? sum.jacobianMax : 0;
  out.foldedVoxelsLeft = sum.foldedVoxels;
  out.activeVoxels = sum.active;
  out.rounding = sum.rounding;
  out.interiorVoxels = sum.interior;
  return std::move(out);
}

void require(const EvaluateSettings& settings) {
  requireNumber("lambda", settings.lame.lambda, {0});
  requireNumber("mu", settings.lame.mu, {0});
  requireNumber("skin", settings.skin, {0, 3}, "voxels");
  requireNumber("accuracy", settings.accuracy, {1e-12, 1e-3}, "of the target's extent");
  requireNumber("target volume", settings.targetVolume, {0});
}

}  // namespace

std::vector<openvdb::GridBase::Ptr> MapGrids::all() const {
  std::vector<openvdb::GridBase::Ptr> grids;
  for (const openvdb::GridBase::Ptr& grid :
       {openvdb::GridBase::Ptr(map), openvdb::GridBase::Ptr(jacobian),
        openvdb::GridBase::Ptr(harmonicEnergy), openvdb::GridBase::Ptr(deformationEnergy),
        openvdb::GridBase::Ptr(repaired), openvdb::GridBase::Ptr(folded)})
    if (grid) grids.push_back(grid);
  return grids;
}

double targetExtent(const ComposedMap& map, const Solid& solid) {
  constexpr std::size_t kSamples = 500;
  const Points& vertices = solid.surface().vertices;
  const std::size_t count = std::min(kSamples, vertices.size());
  Points some(count), images(count);
  for (std::size_t i = 0; i < count; ++i) some[i] = vertices[i * vertices.size() / count];
  map.evaluate(some.data(), count, images.data(), nullptr);
  const double extent = boundingBox(images).diagonal();
  return extent > 0 ? extent : 1;
}

MapGrids mapGridsOn(const openvdb::MaskGrid& region, const EvaluateSettings& wanted) {
  MapGrids grids;
  if (wanted.map) {
    grids.map = named(vectorGridOn(region), "map");
    grids.map->setVectorType(openvdb::VEC_INVARIANT);
  }
  if (wanted.jacobian) grids.jacobian = named(floatGridOn(region), "jacobian");
  if (wanted.harmonicEnergy) grids.harmonicEnergy = named(floatGridOn(region), "harmonic_energy");
  if (wanted.deformationEnergy)
    grids.deformationEnergy = named(floatGridOn(region), "deformation_energy");
  return grids;
}

void MapTotals::add(const MapTotals& t) {
  harmonic += t.harmonic;
  deformation += t.deformation;
  volume += t.volume;
  folded += t.folded;
  active += t.active;
  interior += t.interior;
  foldedVoxels += t.foldedVoxels;
  rounding = std::max(rounding, t.rounding);
  jacobianMin = std::min(jacobianMin, t.jacobianMin);
  jacobianMax = std::max(jacobianMax, t.jacobianMax);
}

std::array<double, MapTotals::kNumbers> MapTotals::numbers() const {
  return {harmonic,
          deformation,
          volume,
          folded,
          rounding,
          jacobianMin,
          jacobianMax,
          static_cast<double>(active),
          static_cast<double>(interior),
          static_cast<double>(foldedVoxels)};
}

MapTotals MapTotals::of(const double* n) {
  const auto count = [](double number) {
    return number > 0 && number < 1e15 ? static_cast<std::uint64_t>(number) : 0;
  };
  return {n[0], n[1], n[2], n[3], n[4], n[5], n[6], count(n[7]), count(n[8]), count(n[9])};
}

openvdb::MaskGrid::Ptr mapRegion(const openvdb::FloatGrid& levelSet,
                                 const EvaluateSettings& settings) {
  require(settings);
  constexpr std::uint64_t kMaskBytes = 1;
  const EvaluateSettings wanted = withRepaired(settings);
  RegionSettings where;
  where.skin = settings.skin;
  where.bytesPerVoxel = kMaskBytes + (wanted.map ? 12 : 0) + (wanted.jacobian ? 4 : 0) +
                        (wanted.harmonicEnergy ? 4 : 0) + (wanted.deformationEnergy ? 4 : 0);
  return activeRegion(levelSet, where);
}

MapValues mapValues(const ComposedMap& map, const FieldRegion& region,
                    const EvaluateSettings& settings) {
  require(settings);
  return Evaluation(map, region.solid(), region.levelSet(), settings).values(region);
}

MapValues mapValues(const ComposedMap& map, const Solid& solid, const openvdb::FloatGrid& levelSet,
                    const EvaluateSettings& settings) {
  const openvdb::MaskGrid::Ptr mask = mapRegion(levelSet, settings);
  return mapValues(map, FieldRegion(solid, levelSet, *mask), settings);
}

MapGrids concludeValues(const ComposedMap& map, const Solid& solid,
                        const openvdb::FloatGrid& levelSet, const EvaluateSettings& settings,
                        MapValues values) {
  return Evaluation(map, solid, levelSet, settings).conclude(std::move(values));
}

MapGrids evaluateMap(const ComposedMap& map, const FieldRegion& region,
                     const EvaluateSettings& settings) {
  return concludeValues(map, region.solid(), region.levelSet(), settings,
                        mapValues(map, region, settings));
}

MapGrids evaluateMap(const ComposedMap& map, const Solid& solid, const openvdb::FloatGrid& levelSet,
                     const EvaluateSettings& settings) {
  return concludeValues(map, solid, levelSet, settings, mapValues(map, solid, levelSet, settings));
}

}  // namespace innermap
