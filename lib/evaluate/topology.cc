#include "evaluate/topology.h"

#include <memory>
#include <vector>

#include "innermap/core/run.h"

namespace innermap {
namespace {

// OpenVDB's own copies of topology compile several times as long: they are parallel at each level,
// and take any configuration of trees.
template <class Tree>
struct Nodes {
  using Root = typename Tree::RootNodeType;
  using Upper = typename Root::ChildNodeType;
  using Lower = typename Upper::ChildNodeType;
  using Leaf = typename Tree::LeafNodeType;
};
using MaskNodes = Nodes<openvdb::MaskTree>;

template <class From, class To, class Value>
void copyTiles(const From& from, To& to, const Value& value) {
  for (auto tile = from.cbeginValueOn(); tile; ++tile) to.addTile(tile.pos(), value, true);
}

template <class Tree>
void addTopology(const Tree& from, openvdb::MaskTree& to) {
  for (auto tile = from.root().cbeginValueOn(); tile; ++tile)
    to.root().addTile(tile.getCoord(), true, true);
  for (auto upper = from.root().cbeginChildOn(); upper; ++upper) {
    auto mine = std::make_unique<MaskNodes::Upper>(upper->origin(), false);
    copyTiles(*upper, *mine, true);
    for (auto lower = upper->cbeginChildOn(); lower; ++lower) {
      auto below = std::make_unique<MaskNodes::Lower>(lower->origin(), false);
      copyTiles(*lower, *below, true);
      for (auto leaf = lower->cbeginChildOn(); leaf; ++leaf)
        below->addChild(new MaskNodes::Leaf(*leaf, openvdb::TopologyCopy()));
      mine->addChild(below.release());
    }
    to.root().addChild(mine.release());
  }
}

template <class Tree>
typename Tree::Ptr treeOn(const openvdb::MaskTree& region,
                          const typename Tree::ValueType& background) {
  using N = Nodes<Tree>;
  auto tree = std::make_shared<Tree>(background);
  for (auto tile = region.root().cbeginValueAll(); tile; ++tile)
    tree->root().addTile(tile.getCoord(), background, tile.isValueOn());
  std::vector<std::pair<const MaskNodes::Lower*, typename N::Lower*>> blocks;
  for (auto upper = region.root().cbeginChildOn(); upper; ++upper) {
    auto* mine = new typename N::Upper(upper->origin(), background);
    tree->root().addChild(mine);
    copyTiles(*upper, *mine, background);
    for (auto lower = upper->cbeginChildOn(); lower; ++lower) {
      blocks.emplace_back(&*lower, new typename N::Lower(lower->origin(), background));
      mine->addChild(blocks.back().second);
    }
  }
  parallelBlocks(blocks.size(), 1, [&](std::size_t begin, std::size_t) {
    const auto& [lower, mine] = blocks[begin];
    copyTiles(*lower, *mine, background);
    for (auto leaf = lower->cbeginChildOn(); leaf; ++leaf)
      mine->addChild(new typename N::Leaf(*leaf, background, openvdb::TopologyCopy()));
  });
  return tree;
}

template <class Grid>
typename Grid::Ptr zeroOn(const openvdb::MaskGrid& region) {
  auto grid = Grid::create();
  grid->setTree(
      treeOn<typename Grid::TreeType>(region.tree(), openvdb::zeroVal<typename Grid::ValueType>()));
  grid->setTransform(region.transform().copy());
  return grid;
}

}  // namespace

openvdb::MaskTree activeTopology(const openvdb::GridBase& grid) {
  openvdb::MaskTree out;
  grid.apply<GridTypes>([&](const auto& typed) { addTopology(typed.tree(), out); });
  return out;
}

openvdb::GridBase::Ptr emptyLike(const openvdb::GridBase& like, const openvdb::MaskGrid& region) {
  openvdb::GridBase::Ptr out;
  like.apply<GridTypes>([&](const auto& typed) {
    using Tree = typename std::decay_t<decltype(typed)>::TreeType;
    auto grid = typed.copyWithNewTree();
    if constexpr (std::is_same_v<Tree, openvdb::MaskTree>)
      addTopology(region.tree(), grid->tree());
    else
      grid->setTree(treeOn<Tree>(region.tree(), typed.background()));
    out = grid;
  });
  if (out) out->setTransform(region.transform().copy());
  return out;
}

openvdb::FloatGrid::Ptr floatGridOn(const openvdb::MaskGrid& region) {
  return zeroOn<openvdb::FloatGrid>(region);
}

openvdb::Vec3SGrid::Ptr vectorGridOn(const openvdb::MaskGrid& region) {
  return zeroOn<openvdb::Vec3SGrid>(region);
}

}  // namespace innermap
