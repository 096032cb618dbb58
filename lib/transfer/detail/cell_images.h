// Where each voxel of the target comes from, to second order.
//
// The cells of a lattice through the source are cut into six tetrahedra each (Kuhn's, which fit
// together across cells) and mapped by their corners; a voxel in the image of one has that one's
// barycentric coordinates.
#pragma once

#include <openvdb/openvdb.h>

#include <array>
#include <bitset>
#include <cstdint>
#include <vector>

#include "transfer/detail/extended_map.h"
#include "transfer/detail/leaf_index.h"

namespace innermap {

// Of the voxels of one leaf of the target's region.
struct LeafStarts {
  std::array<openvdb::Vec3f, 512> source;  // index space of the source's lattice
  std::array<float, 512> outside;          // distance from the source's solid, world units
  std::bitset<512> covered;
};

// The lattice's images: target index space. region: active voxels of the lattice.
struct LatticeImages {
  openvdb::Vec3SGrid::Ptr images;
  openvdb::FloatGrid::Ptr outside;  // distance from the solid, world units
  bool mirrored = false;  // most of the inside has a negative Jacobian: also where no target tells
                          // of the sense, as through cells
};
LatticeImages imagesOf(const ExtendedMap& map, const openvdb::MaskGrid& region,
                       const openvdb::math::Transform& target);

// Leaves of the target's lattice that images of cells no farther outside than `mostOutside` (world
// units of the source) may touch, all voxels on. Throws MemoryError when they are too many.
openvdb::MaskGrid::Ptr touchedLeaves(const LatticeImages& lattice, double mostOutside,
                                     std::uint64_t mostLeaves);

// One for each leaf of `region` in its order. Where several images cover a voxel (folds, parts that
// the target lets overlap) the one nearest to the source's inside is taken, of those one turned
// like the whole (`mirrored`: with a negative Jacobian), of those the first.
std::vector<LeafStarts> findStarts(const LatticeImages& lattice, const openvdb::MaskGrid& region);

// Voxels of the leaves that nothing covers start where their nearest covered neighbour does. They
// stay uncovered, but for a start. starts: the leaves' own.
void spreadStarts(const LeafIndex& leaves, LeafStarts* starts);

}  // namespace innermap
