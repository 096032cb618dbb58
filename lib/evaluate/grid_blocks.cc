#include "evaluate/grid_blocks.h"

#include <openvdb/tools/Merge.h>

#include <algorithm>
#include <cmath>

#include "evaluate/topology.h"
#include "evaluate/visit_field.h"
#include "innermap/core/error.h"
#include "innermap/core/run.h"

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

// Totals come from files, and these may hold any numbers.
bool beginsWithOrigin(const std::vector<double>& totals) {
  constexpr double kFarthest = 1e9;
  return std::all_of(totals.begin(), totals.begin() + 3, [&](double at) {
    return std::abs(at) < kFarthest && !(std::abs(std::remainder(at, kBlock)) > 0);
  });
}

Coord originFrom(const std::vector<double>& totals) {
  return {static_cast<int>(totals[0]), static_cast<int>(totals[1]), static_cast<int>(totals[2])};
}

}  // namespace

std::vector<VoxelBlock> voxelBlocks(const Solid& solid, const LevelSetSettings& settings) {
  const Cubes cubes(solid, settings);
  std::vector<VoxelBlock> all = cubes.all(), out;
  parallelBlocks(all.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) all[i].voxels = cubes.weightOf(all[i].origin);
  });
  for (const VoxelBlock& block : all)
    if (block.voxels > 0) out.push_back(block);
  return out;
}

std::vector<double> totalsOf(const BlockSums& sums) {
  std::vector<double> out;
  for (int a = 0; a < 3; ++a) out.push_back(sums.block[a]);
  out.insert(out.end(), sums.numbers.begin(), sums.numbers.end());
  return out;
}

GridBlocks::GridBlocks(std::vector<GridBlock> blocks, openvdb::math::Transform::Ptr transform,
                       std::size_t numbers)
    : blocks_(std::move(blocks)), transform_(std::move(transform)) {
  for (const GridBlock& block : blocks_)
    if (block.totals.size() != 3 + numbers || !beginsWithOrigin(block.totals))
      throw DataError(block.name + ": its totals are none of this volume's; make its share again");
  std::sort(blocks_.begin(), blocks_.end(), [](const GridBlock& a, const GridBlock& b) {
    return originFrom(a.totals) < originFrom(b.totals);
  });
  for (const GridBlock& block : blocks_) {
    const Coord origin = originFrom(block.totals);
    if (!sums_.empty() && sums_.back().block == origin)
      throw DataError(block.name + ": another file holds the same block of the volume; remove one");
    sums_.push_back({origin, {block.totals.begin() + 3, block.totals.end()}});
  }
}

void GridBlocks::refuse(const GridBlock& block, const std::string& name) {
  throw DataError(block.name + ": its grid '" + name +
                  "' is no part of this volume; make its share again");
}

template <class Grid>
typename Grid::Ptr GridBlocks::gridOf(std::size_t block, const std::string& name) const {
  const CoordBBox within = CoordBBox::createCube(sums_[block].block, kBlock);
  for (const openvdb::GridBase::Ptr& grid : blocks_[block].grids) {
    if (!grid || grid->getName() != name) continue;
    const auto typed = openvdb::gridPtrCast<Grid>(grid);
    if (!typed || typed->transform() != *transform_) break;
    const CoordBBox box = typed->evalActiveVoxelBoundingBox();
    if (!box.empty() && !within.isInside(box)) break;
    return typed;
  }
  refuse(blocks_[block], name);
}

void GridBlocks::mergeInto(openvdb::GridBase& whole, const std::string& name) {
  whole.apply<GridTypes>([&](auto& typed) {
    using Grid = std::decay_t<decltype(typed)>;
    for (std::size_t b = 0; b < blocks_.size(); ++b) {
      throwIfCancelled();
      typed.tree().merge(gridOf<Grid>(b, name)->tree(), openvdb::MERGE_NODES);
    }
  });
}

openvdb::FloatGrid::Ptr GridBlocks::levelSet() {
  constexpr const char* kName = "surface";
  std::vector<openvdb::FloatTree*> trees;
  for (std::size_t b = 0; b < blocks_.size(); ++b) {
    trees.push_back(&gridOf<openvdb::FloatGrid>(b, kName)->tree());
    if (trees.back()->background() != trees.front()->background()) refuse(blocks_[b], kName);
  }
  if (trees.empty()) throw DataError("the volume has no blocks");
  const auto out = openvdb::FloatGrid::create(trees.front()->background());
  out->setTransform(transform_);
  out->setGridClass(openvdb::GRID_LEVEL_SET);
  out->setName(kName);
  const openvdb::tools::CsgUnionOp<openvdb::FloatTree> unite(trees, openvdb::Steal());
  openvdb::tree::DynamicNodeManager<openvdb::FloatTree> nodes(out->tree());
  nodes.foreachTopDown(unite);
  return out;
}

std::vector<std::string> GridBlocks::names() const {
  std::vector<std::string> out;
  if (!blocks_.empty())
    for (const openvdb::GridBase::Ptr& grid : blocks_.front().grids) out.push_back(grid->getName());
  return out;
}

}  // namespace innermap
