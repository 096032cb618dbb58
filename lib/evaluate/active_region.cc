#include "evaluate/active_region.h"

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "innermap/core/error.h"
#include "innermap/core/memory.h"
#include "innermap/core/run.h"

namespace innermap {
namespace {

using Leaf = openvdb::MaskTree::LeafNodeType;
using Upper = openvdb::MaskTree::RootNodeType::ChildNodeType;
using Lower = Upper::ChildNodeType;

std::vector<std::unique_ptr<Leaf>> leavesBelow(const openvdb::FloatTree& distances, float iso) {
  std::vector<const openvdb::FloatTree::LeafNodeType*> from;
  distances.getNodes(from);
  std::vector<std::unique_ptr<Leaf>> out(from.size());
  parallelBlocks(from.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t l = begin; l < end; ++l) {
      auto leaf = std::make_unique<Leaf>(from[l]->origin(), false);
      for (openvdb::Index i = 0; i < Leaf::SIZE; ++i)
        if (from[l]->getValue(i) < iso) leaf->setValueOn(i);
      if (!leaf->isEmpty()) out[l] = std::move(leaf);
    }
  });
  return out;
}

// Tiles whose distance is below iso become active in the node; how many.
template <class Node>
std::uint64_t fillTiles(Node& node, const openvdb::FloatTree& distances, float iso) {
  const openvdb::tree::ValueAccessor<const openvdb::FloatTree, false> at(distances);
  std::uint64_t count = 0;
  for (auto tile = node.beginValueAll(); tile; ++tile)
    if (at.getValue(tile.getCoord()) < iso) {
      node.addTile(tile.pos(), true, true);
      ++count;
    }
  return count;
}

// As openvdb::tools::sdfInteriorMask, whose header takes seconds to compile. Returns the number of
// leaves that the mask has once its tiles are voxels.
std::uint64_t maskBelow(const openvdb::FloatTree& distances, float iso, openvdb::MaskTree& out) {
  std::uint64_t leaves = 0;
  for (std::unique_ptr<Leaf>& leaf : leavesBelow(distances, iso)) {
    if (!leaf) continue;
    out.addLeaf(leaf.release());
    ++leaves;
  }
  // Where there are tiles alone, no leaf has made a node.
  for (auto upper = distances.root().cbeginChildOn(); upper; ++upper)
    if (!out.probeConstNode<Upper>(upper.getCoord()))
      out.root().addChild(new Upper(upper.getCoord(), false));
  for (auto upper = out.root().beginChildOn(); upper; ++upper) {
    for (auto lower = upper->beginChildOn(); lower; ++lower)
      leaves += fillTiles(*lower, distances, iso);
    leaves += fillTiles(*upper, distances, iso) * Lower::NUM_VALUES;
  }
  return leaves;
}

}  // namespace

openvdb::MaskGrid::Ptr activeRegion(const openvdb::FloatGrid& levelSet,
                                    const RegionSettings& settings) {
  const double voxel = levelSet.voxelSize()[0], skin = settings.skin;
  const float background = levelSet.background();
  if (!(skin >= 0) || skin * voxel > background * (1 + 1e-6))
    throw SettingError("skin", "of " + std::to_string(skin) +
                                   " voxels is wider than the level set's band; widen the band");
  // Values below the isovalue are taken; the skin's edge itself belongs to it.
  const auto iso = static_cast<float>(std::nextafter(skin * voxel, INFINITY));
  const float most = std::min(std::nextafter(background, 0.f),
                              background - openvdb::math::Tolerance<float>::value());
  auto region = openvdb::MaskGrid::create();
  region->setTransform(levelSet.transform().copy());
  const std::uint64_t leaves = maskBelow(levelSet.tree(), std::min(iso, most), region->tree());
  throwIfCancelled();
  requireMemory("evaluating " + std::to_string(leaves) + " blocks of 8^3 voxels",
                leaves * Leaf::SIZE * settings.bytesPerVoxel,
                "use a larger --voxel-size or a lower --resolution (memory grows with its cube)");
  region->tree().voxelizeActiveTiles();
  return region;
}

}  // namespace innermap
