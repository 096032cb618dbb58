// Exact distances to a solid's surface on the voxels of a band around some
// level of them, found from coarse blocks to fine ones.
#pragma once

#include <openvdb/openvdb.h>

#include <vector>

#include "levelset/detail/solid_body.h"

namespace innermap {

// The band of unsigned distances in [lower, upper], world units, on a lattice of voxel centres
// origin + voxelSize * (i, j, k).
class Band {
 public:
  static constexpr int kLeaf = 8;  // voxels along a side of a leaf
  static constexpr int kLeafVoxels = kLeaf * kLeaf * kLeaf;

  // Keeps a reference to the body. within: leaves that meet it are all that there are.
  Band(const SolidBody& body, const Vec3& origin, double voxelSize, double lower, double upper,
       const openvdb::CoordBBox& within = openvdb::CoordBBox::inf());

  // Origins of the leaves (multiples of 8) that may have voxels in the band, in a fixed order.
  std::vector<openvdb::Coord> leaves() const;

  // Number of leaves, over-estimated by at most about a half, without going down to them.
  double estimateLeaves() const;

  // Distances at a leaf's voxels, in the order of leaf storage: exact in the band, infinity where
  // farther, 0 where nearer.
  void distances(const openvdb::Coord& leaf, double* values) const;

  Vec3 position(const openvdb::Coord& voxel) const;

 private:
  struct Level;
  Level firstLevel() const;
  Level refined(const Level& level) const;
  bool mayTouch(const openvdb::Coord& corner, int size) const;
  struct Filling;
  void fill(const openvdb::Coord& corner, int size, double bound, const TriangleTree::Part& near,
            Filling& filling) const;

  const SolidBody& body_;
  Vec3 origin_;
  double voxelSize_, lower_, upper_;
  openvdb::CoordBBox within_;
};

}  // namespace innermap
