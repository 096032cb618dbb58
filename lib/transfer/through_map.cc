
#include "innermap/core/run.h"
#include "innermap/transfer/inverse_map.h"

namespace innermap {
namespace {

constexpr std::size_t kLeaves = 64;  // whose points are carried together

}  // namespace

void forLeavesThrough(
    const openvdb::MaskGrid& region,
    const std::function<void(const Points&, Points&, std::vector<Mat3>&)>& way,
    const std::function<void(std::size_t leaf, const openvdb::Coord& origin, const Points& images,
                             const std::vector<Mat3>& jacobians)>& use) {
  std::vector<const openvdb::MaskTree::LeafNodeType*> leaves;
  for (auto leaf = region.tree().cbeginLeaf(); leaf; ++leaf) leaves.push_back(&*leaf);
  parallelBlocks(
      leaves.size(), kLeaves,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t l = begin; l < end; ++l) {
          Points at, images;
          std::vector<Mat3> jacobians;
          for (auto voxel = leaves[l]->cbeginValueOn(); voxel; ++voxel) {
            const openvdb::Vec3d p = region.indexToWorld(voxel.getCoord());
            at.push_back({p.x(), p.y(), p.z()});
          }
          way(at, images, jacobians);
          use(l, leaves[l]->origin(), images, jacobians);
        }
      },
      "carrying voxels");
}

InvertedMap invertThrough(const ThroughMap& through, const openvdb::MaskGrid::Ptr& region) {
  InvertedMap out;
  out.region = region;
  out.first = {0};
  for (auto leaf = region->tree().cbeginLeaf(); leaf; ++leaf)
    out.first.push_back(out.first.back() + leaf->onVoxelCount());
  const std::size_t count = out.first.back();
  out.sources.resize(count);
  out.jacobians.resize(count);
  forLeavesThrough(*region, through.pull,
                   [&](std::size_t leaf, const openvdb::Coord&, const Points& images,
                       const std::vector<Mat3>& jacobians) {
                     for (std::size_t i = 0; i < images.size(); ++i) {
                       out.sources[out.first[leaf] + i] = images[i];
                       const Mat3 j = inverse(jacobians[i]);
                       for (std::size_t k = 0; k < 9; ++k)
                         out.jacobians[out.first[leaf] + i][k] =
                             static_cast<float>(j[k / 3][k % 3]);
                     }
                   });
  out.statistics.voxels = out.statistics.inverted = count;
  return out;
}

}  // namespace innermap
