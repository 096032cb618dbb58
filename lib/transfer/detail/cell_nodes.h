// The corners of the cells that a density is carried in, and where the map brings them.
#pragma once

#include <openvdb/openvdb.h>

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "transfer/detail/extended_map.h"
#include "transfer/detail/leaf_index.h"

namespace innermap {

inline int floorDivide(int a, int b) { return a >= 0 ? a / b : -((b - 1 - a) / b); }

// A linear transform's way from world units to indices.
struct Lattice {
  Mat3 linear;
  Vec3 shift;

  explicit Lattice(const openvdb::math::Transform& transform);
  Vec3 toIndex(const Vec3& p) const { return linear * p + shift; }
};

// Holds a reference. Voxels are cut into parts^3 cells. Cell (i, j, k) has its lowest corner at
// node (i, j, k), which is at index (i, j, k) / parts - 1/2 of the voxels.
class CellNodes {
 public:
  static constexpr int kSide = 9;  // nodes along the cells of one leaf

  // Of the cells in the voxels of `voxels`, whose transform is `grid`.
  CellNodes(const openvdb::MaskTree& voxels, const openvdb::math::Transform& grid, int parts);

  std::size_t size() const { return first_.back(); }
  const LeafIndex& leaves() const { return leaves_; }
  openvdb::Coord voxelOf(const openvdb::Coord& cell) const;
  Vec3 worldOf(const openvdb::Vec3d& node) const;

  // Bytes that map() allocates for so many nodes.
  static std::uint64_t memory(std::size_t nodes);

  // Finds the images: in the target's index space, shifted by half a voxel so that voxel (i, j, k)
  // spans [i, i + 1] and so on.
  void map(const ExtendedMap& map, const Lattice& target, std::string_view stage);

  // Of the nodes (9^3, z fastest) of the cells whose lowest corner is in a leaf. stretch: how long,
  // in voxels of the target, the map's derivative makes the longest of a cell's three edges;
  // infinite deep inside the solid. NaN where there is no node.
  struct Corners {
    std::array<Vec3, kSide * kSide * kSide> images;
    std::array<float, kSide * kSide * kSide> stretch;
  };
  void corners(std::size_t leaf, Corners& out) const;

  // The edges of a cell, world units.
  const std::array<Vec3, 3>& edges() const { return edges_; }

 private:
  const openvdb::math::Transform& grid_;
  int parts_;
  std::array<Vec3, 3> edges_;
  openvdb::MaskTree nodes_;
  LeafIndex leaves_;
  std::vector<std::size_t> first_;  // of each leaf, #leaves + 1
  Points images_;
  std::vector<float> stretch_;
};

}  // namespace innermap
