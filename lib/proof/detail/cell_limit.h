// How many cells a proof may look at.
#pragma once

#include <algorithm>
#include <cstdint>

#include "innermap/proof/prove.h"

namespace innermap::proof {

// Of the boundary: what takes more than cells do.
constexpr std::uint64_t kBytesPerPiece = 400;

inline std::uint64_t cellLimit(const ComposedMap& map, const ProofSettings& settings) {
  const double cells = settings.cellsPerCharge * static_cast<double>(map.sources());
  return std::max(settings.leastCells, static_cast<std::uint64_t>(std::min(cells, 1e12)));
}

}  // namespace innermap::proof
