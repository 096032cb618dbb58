// Sets of blocks made for tests.
#pragma once

#include "innermap/tetra/hexahedralize.h"

namespace innermap {

// A lattice of so many blocks along each axis, with an edge of 0.5.
inline BlockSet emptyBlocks(int across) {
  BlockSet blocks;
  blocks.edge = 0.5;
  blocks.size = {across, across, across};
  blocks.filled.assign(static_cast<std::size_t>(across * across * across), 0);
  return blocks;
}

// Eight blocks around a hole.
inline BlockSet ringOfBlocks() {
  BlockSet blocks = emptyBlocks(5);
  for (int y = 1; y <= 3; ++y)
    for (int x = 1; x <= 3; ++x)
      if (x != 2 || y != 2) blocks.filled[blocks.index({x, y, 2})] = 1;
  return blocks;
}

}  // namespace innermap
