// The set of blocks of a given topology that is nearest to a solid.
#pragma once

#include <optional>
#include <vector>

#include "tetra/detail/block_shares.h"

namespace innermap {

struct FoundBlocks {
  BlockSet blocks;
  std::vector<double> shares;  // of each block of the lattice
  double cost = 0;             // volume missed and volume too much, world units cubed
  int shift = 0;               // of the lattice, as BlockShares takes it
  bool grown = false;          // from one block, as no threshold gave the topology
};

// handles: of the outer boundary, then of those of cavities, ascending. Nothing where none is
// found.
std::optional<FoundBlocks> findBlocks(const BlockShares& shares, const std::vector<int>& handles);

}  // namespace innermap
