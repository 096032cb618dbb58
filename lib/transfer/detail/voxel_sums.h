// What has been put into the voxels of a target, leaf by leaf.
#pragma once

#include <openvdb/openvdb.h>

#include <array>
#include <map>
#include <vector>

namespace innermap {

class VoxelSums {
 public:
  struct Sum {
    double volume = 0, mass = 0;
  };
  using LeafSums = std::array<Sum, 512>;

  VoxelSums() = default;
  VoxelSums(VoxelSums&&) = default;
  VoxelSums& operator=(VoxelSums&&) = default;

  void add(const openvdb::Coord& voxel, double volume, double mass) {
    using Leaf = openvdb::MaskTree::LeafNodeType;
    const openvdb::Coord origin = voxel & ~7;
    if (!last_ || origin != lastOrigin_) {
      last_ = &leaves_[origin];
      lastOrigin_ = origin;
    }
    Sum& sum = (*last_)[Leaf::coordToOffset(voxel)];
    sum.volume += volume;
    sum.mass += mass;
  }

  // Adds all of `parts` in their order, on all threads; takes their memory.
  void add(std::vector<VoxelSums>& parts);

  // By origin.
  const std::map<openvdb::Coord, LeafSums>& leaves() const { return leaves_; }

 private:
  std::map<openvdb::Coord, LeafSums> leaves_;
  LeafSums* last_ = nullptr;
  openvdb::Coord lastOrigin_;
};

}  // namespace innermap
