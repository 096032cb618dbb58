// The leaves of a region by number, and values that spread from voxel to
// voxel through it.
#pragma once

#include <openvdb/openvdb.h>

#include <bitset>
#include <cstdint>
#include <functional>
#include <unordered_map>
#include <vector>

namespace innermap {

class LeafIndex {
 public:
  using Leaf = openvdb::MaskTree::LeafNodeType;
  static constexpr std::uint32_t kNone = ~std::uint32_t{0};

  explicit LeafIndex(const openvdb::MaskTree& region);
  explicit LeafIndex(std::vector<const Leaf*> leaves);

  std::size_t size() const { return leaves_.size(); }
  const Leaf& operator[](std::size_t i) const { return *leaves_[i]; }

  // The leaf that holds a voxel, or kNone.
  std::uint32_t find(const openvdb::Coord& ijk) const;

 private:
  std::vector<const Leaf*> leaves_;
  std::unordered_map<std::uint64_t, std::uint32_t> byOrigin_;
};

// A voxel by its leaf's number and its place there.
struct LeafPlace {
  std::uint32_t leaf = 0;
  std::uint16_t offset = 0;
};

// Gives each active voxel of the region whose bit in `has` is off what its nearest neighbour with
// one has, layer by layer: calls copy(from, to) and sets the bit. Voxels that nothing reaches stay
// off. The same for any number of threads.
void spreadToNeighbours(const LeafIndex& region, std::vector<std::bitset<512>>& has,
                        const std::function<void(LeafPlace from, LeafPlace to)>& copy);

}  // namespace innermap
