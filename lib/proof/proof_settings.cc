#include "innermap/proof/prove.h"
#include "proof/detail/cell_limit.h"
#include "proof/detail/field_tree.h"

namespace innermap {

std::vector<Setting> describe(ProofSettings& s) {
  return {Setting("cells_per_charge", "N", &s.cellsPerCharge,
                  "cells that a proof looks at, in proportion to the charges, before it leaves the "
                  "rest undecided")
              .from(1, 1e6),
          Setting("least_cells", "N", &s.leastCells, "cells that a proof looks at in any case")
              .from(1, 1e12)
              .rare(),
          Setting("error_margin", "SHARE", &s.errorMargin,
                  "how near the proven boundary error comes to the largest that is seen")
              .from(1e-3, 1)};
}

std::uint64_t proofMemory(const ComposedMap& map, std::size_t triangles,
                          const ProofSettings& settings) {
  return (proof::passesCharges(map) ? 2 : 1) * proof::FieldTree::memory(map.sources()) +
         proof::kBytesPerPiece * proof::pieceLimit(map, triangles, settings);
}

}  // namespace innermap
