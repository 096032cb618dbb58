// Sets of blocks as solids: whether their boundary is a surface, and of which kind.
#pragma once

#include <vector>

#include "innermap/tetra/hexahedralize.h"

namespace innermap {

// Whether the eight blocks around the lattice corner (the lower corner of block `corner`) meet
// there in a surface without pinch: their filled ones hang together by faces, and so do the empty
// ones. Each index of corner in [1, size - 1].
bool manifoldAt(const BlockSet& blocks, const Block& corner);

bool isManifold(const BlockSet& blocks);

// Whether filling or emptying the block changes nothing of the topology of a manifold set, and
// leaves it manifold: of the block's faces those beside filled blocks form a disc, and so do the
// others. Not for blocks of the outermost layer.
bool isSimple(const BlockSet& blocks, const Block& block);

struct BlockTopology {
  int bodies = 0;            // filled blocks that hang together by faces
  std::vector<int> handles;  // of the outer boundary, then of those of cavities, ascending
  int cavities() const { return static_cast<int>(handles.size()) - 1; }
};

// Of a manifold set of one body; handles are empty when it has none or several.
BlockTopology topologyOf(const BlockSet& blocks);

// Components by faces of the filled blocks, or of the others: a number each from 0, in the order of
// their first blocks; -1 elsewhere. Returns their number.
int labelBlocks(const BlockSet& blocks, bool filled, std::vector<int>& labels);

}  // namespace innermap
