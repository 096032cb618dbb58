#include "evaluate/detail/map_blocks.h"

#include "evaluate/grid_blocks.h"
#include "levelset/level_set_settings.h"

namespace innermap {

std::vector<double> totalsOf(const BlockTotals& totals) {
  const auto numbers = totals.totals.numbers();
  return totalsOf(BlockSums{totals.block, {numbers.begin(), numbers.end()}});
}

MapValues mergeBlocks(std::vector<GridBlock> blocks, const openvdb::math::Transform::Ptr& transform,
                      openvdb::FloatGrid::Ptr& surface) {
  GridBlocks all(std::move(blocks), transform, MapTotals::kNumbers);
  MapValues out;
  for (const BlockSums& sums : all.sums())
    out.blocks.push_back({sums.block, MapTotals::of(sums.numbers.data())});
  openvdb::MaskGrid nothing;
  nothing.setTransform(transform->copy());
  out.grids = mapGridsOn(nothing, {});
  surface = all.levelSet();
  for (const openvdb::GridBase::Ptr& grid : out.grids.all()) all.mergeInto(*grid, grid->getName());
  return out;
}

GridBlock voxelizeBlock(const Solid& solid, const LevelSetSettings& settings,
                        const Mesh* attributes, const openvdb::Coord& origin) {
  const openvdb::FloatGrid::Ptr surface = makeLevelSetBlock(solid, settings, origin);
  GridBlock out{{surface}, totalsOf(BlockSums{origin, {}})};
  if (attributes)
    for (const auto& grid : makeAttributeGrids(*surface, solid, *attributes))
      out.grids.push_back(grid);
  return out;
}

openvdb::GridPtrVec joinVoxelized(const Solid& solid, const LevelSetSettings& settings,
                                  std::vector<GridBlock> blocks) {
  GridBlocks all(std::move(blocks), transformFor(solid, voxelSizeFor(solid, settings)), 0);
  const openvdb::FloatGrid::Ptr surface = all.levelSet();
  openvdb::GridPtrVec out{surface};
  for (const std::string& name : all.names()) {
    if (name == surface->getName()) continue;
    out.push_back(attributeGrid(*surface, name));
    all.mergeInto(*out.back(), name);
  }
  return out;
}

}  // namespace innermap
