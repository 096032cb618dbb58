// How much of each block of a lattice lies inside of a solid.
#pragma once

#include <vector>

#include "innermap/levelset/solid.h"
#include "innermap/tetra/hexahedralize.h"

namespace innermap {

// Shares of half blocks; eight of them give the blocks of any half-block shift of the lattice.
class BlockShares {
 public:
  // across: blocks along the longest side of the solid's box, at least 1.
  BlockShares(const Solid& solid, int across);

  // The lattice shifted by that many half blocks along each axis (bits of shift), in [0, 8): an
  // empty set, and the share of each of its blocks.
  BlockSet lattice(int shift) const;
  std::vector<double> shares(const BlockSet& lattice, int shift) const;

  // The half blocks themselves: they lie within the unshifted lattice.
  const std::array<int, 3>& halves() const { return halves_; }
  double half(const std::array<int, 3>& h) const {
    return share_[(static_cast<std::size_t>(h[2]) * halves_[1] + h[1]) * halves_[0] + h[0]];
  }
  Vec3 centreOfHalf(const std::array<int, 3>& h) const {
    return lower_ + 0.5 * edge_ * Vec3{h[0] + 0.5, h[1] + 0.5, h[2] + 0.5};
  }

 private:
  double edge_ = 0;  // of a block, world units
  Vec3 lower_;
  std::array<int, 3> halves_{};
  std::vector<float> share_;  // of half blocks, x fastest
};

}  // namespace innermap
