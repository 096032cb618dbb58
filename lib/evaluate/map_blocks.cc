#include "evaluate/detail/map_blocks.h"

#include <openvdb/tools/Merge.h>

#include <cmath>
#include <set>

#include "evaluate/visit_field.h"
#include "innermap/core/error.h"
#include "innermap/core/run.h"
#include "innermap/levelset/level_set.h"
#include "levelset/level_set_settings.h"

namespace innermap {
namespace {

using openvdb::Coord;
using openvdb::CoordBBox;

constexpr int kBlock = 128, kPart = 32;  // voxels; blockOf()

// What of a solid a cube of voxels may hold.
class Cubes {
 public:
  Cubes(const Solid& solid, const LevelSetSettings& settings)
      : solid_(solid),
        voxel_(voxelSizeFor(solid, settings)),
        reach_((settings.halfWidth + 1) * voxel_),
        transform_(transformFor(solid, voxel_)) {}

  // All blocks about the solid, ascending.
  std::vector<VoxelBlock> all() const {
    const auto index = [&](const Vec3& p) {
      return transform_->worldToIndex(openvdb::Vec3d(p.x, p.y, p.z));
    };
    const Vec3 reach{reach_, reach_, reach_};
    const Coord first = blockOf(Coord::floor(index(solid_.box().lower - reach))),
                last = Coord::ceil(index(solid_.box().upper + reach));
    std::vector<VoxelBlock> out;
    for (int x = first.x(); x <= last.x(); x += kBlock)
      for (int y = first.y(); y <= last.y(); y += kBlock)
        for (int z = first.z(); z <= last.z(); z += kBlock) out.push_back({{x, y, z}, 0});
    return out;
  }

  std::uint64_t weightOf(const Coord& block) const {
    if (!nearSurface(block, kBlock))
      return solid_.inside(middle(block, kBlock)) ? cubed(kBlock) : 0;
    std::uint64_t sum = 0;
    for (int x = 0; x < kBlock; x += kPart)
      for (int y = 0; y < kBlock; y += kPart)
        for (int z = 0; z < kBlock; z += kPart) sum += weightOfPart(block.offsetBy(x, y, z));
    return sum;
  }

 private:
  static std::uint64_t cubed(int edge) {
    return static_cast<std::uint64_t>(edge) * static_cast<std::uint64_t>(edge * edge);
  }

  // Along the surface distances take about twice the time of the sums inside.
  std::uint64_t weightOfPart(const Coord& part) const {
    if (nearSurface(part, kPart)) return 2 * cubed(kPart);
    return solid_.inside(middle(part, kPart)) ? cubed(kPart) : 0;
  }

  Vec3 middle(const Coord& cube, int edge) const {
    const openvdb::Vec3d p =
        transform_->indexToWorld(cube.asVec3d() + openvdb::Vec3d(0.5 * (edge - 1)));
    return {p.x(), p.y(), p.z()};
  }

  bool nearSurface(const Coord& cube, int edge) const {
    const double radius = 0.5 * std::sqrt(3.0) * edge * voxel_;
    return solid_.closest(middle(cube, edge), reach_ + radius).onSurface.triangle >= 0;
  }

  const Solid& solid_;
  double voxel_, reach_;
  openvdb::math::Transform::Ptr transform_;
};

[[noreturn]] void refuse(const std::string& name) {
  throw DataError("a block of the volume: its grid '" + name + "' is no part of this map's grids");
}

// A grid of the block, all of it within.
template <class Grid>
typename Grid::Ptr gridOf(const MapBlock& block, const std::string& name, const CoordBBox& within,
                          const openvdb::math::Transform& transform) {
  for (const openvdb::GridBase::Ptr& grid : block.grids) {
    if (!grid || grid->getName() != name) continue;
    const auto typed = openvdb::gridPtrCast<Grid>(grid);
    if (!typed || typed->transform() != transform) refuse(name);
    const CoordBBox box = typed->evalActiveVoxelBoundingBox();
    if (!box.empty() && !within.isInside(box)) refuse(name);
    return typed;
  }
  refuse(name);
}

BlockTotals totalsOf(const std::vector<double>& numbers) {
  if (numbers.size() != 3 + MapTotals::kNumbers) refuse("map");
  const auto at = [&](std::size_t i) {
    return std::abs(numbers[i]) < 1e9 ? static_cast<int>(numbers[i]) : 1;
  };
  const BlockTotals out{{at(0), at(1), at(2)}, MapTotals::of(numbers.data() + 3)};
  if (blockOf(out.block) != out.block) refuse("map");
  return out;
}

// On the transform itself: copies, and those of files, differ in their last bits.
openvdb::FloatGrid::Ptr merged(const std::vector<openvdb::FloatGrid::Ptr>& levelSets,
                               const openvdb::math::Transform::Ptr& transform) {
  if (levelSets.empty()) refuse("surface");
  const auto out = openvdb::FloatGrid::create(levelSets.front()->background());
  out->setTransform(transform);
  out->setGridClass(openvdb::GRID_LEVEL_SET);
  out->setName("surface");
  std::vector<openvdb::FloatTree*> trees;
  for (const openvdb::FloatGrid::Ptr& levelSet : levelSets) {
    if (levelSet->background() != out->background()) refuse("surface");
    trees.push_back(&levelSet->tree());
  }
  const openvdb::tools::CsgUnionOp<openvdb::FloatTree> unite(trees, openvdb::Steal());
  openvdb::tree::DynamicNodeManager<openvdb::FloatTree> nodes(out->tree());
  nodes.foreachTopDown(unite);
  return out;
}

}  // namespace

std::vector<VoxelBlock> voxelBlocks(const Solid& solid, const MapGridSettings& settings) {
  const Cubes cubes(solid, levelSetSettings(settings));
  std::vector<VoxelBlock> all = cubes.all(), out;
  parallelBlocks(all.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) all[i].voxels = cubes.weightOf(all[i].origin);
  });
  for (const VoxelBlock& block : all)
    if (block.voxels > 0) out.push_back(block);
  return out;
}

std::vector<double> numbersOf(const BlockTotals& totals) {
  std::vector<double> out;
  for (int a = 0; a < 3; ++a) out.push_back(totals.block[a]);
  for (const double number : totals.totals.numbers()) out.push_back(number);
  return out;
}

MapValues mergeBlocks(std::vector<MapBlock>& blocks, const openvdb::math::Transform::Ptr& transform,
                      openvdb::FloatGrid::Ptr& surface) {
  MapValues out;
  openvdb::MaskGrid nothing;
  nothing.setTransform(transform->copy());
  MapGrids& grids = out.grids = mapGridsOn(nothing, {});
  std::vector<openvdb::FloatGrid::Ptr> levelSets;
  std::set<Coord> seen;
  for (MapBlock& block : blocks) {
    throwIfCancelled();
    out.blocks.push_back(totalsOf(block.totals));
    const Coord origin = out.blocks.back().block;
    if (!seen.insert(origin).second) throw DataError("a block of the volume is there twice");
    const CoordBBox within = CoordBBox::createCube(origin, kBlock);
    const auto take = [&](auto& whole) {
      using Grid = std::decay_t<decltype(*whole)>;
      const auto part = gridOf<Grid>(block, whole->getName(), within, *transform);
      whole->tree().merge(part->tree(), openvdb::MERGE_NODES);
    };
    levelSets.push_back(gridOf<openvdb::FloatGrid>(block, "surface", within, *transform));
    take(grids.map);
    take(grids.jacobian);
    take(grids.harmonicEnergy);
    take(grids.deformationEnergy);
    block.grids.clear();
  }
  surface = merged(levelSets, transform);
  return out;
}

}  // namespace innermap
