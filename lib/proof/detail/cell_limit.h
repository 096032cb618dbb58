// How many cells and pieces of triangles a proof may look at.
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

// Of a boundary's triangles. Between solids that were laid on one another there are 8 to 15 a
// charge until all have a bound.
inline std::uint64_t pieceLimit(const ComposedMap& map, std::size_t triangles,
                                const ProofSettings& settings) {
  return std::max<std::uint64_t>(2 * cellLimit(map, settings), 8 * std::uint64_t{triangles});
}

}  // namespace innermap::proof
