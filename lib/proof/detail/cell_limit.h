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

// The image of the boundary has to pass between the charges of later steps: that takes finer
// expansions and more pieces, 8 to 15 a charge between solids that were laid on one another.
inline bool passesCharges(const ComposedMap& map) { return map.steps().size() > 1; }

// Of a boundary's triangles.
inline std::uint64_t pieceLimit(const ComposedMap& map, std::size_t triangles,
                                const ProofSettings& settings) {
  return std::max<std::uint64_t>((passesCharges(map) ? 2 : 1) * cellLimit(map, settings),
                                 8 * std::uint64_t{triangles});
}

}  // namespace innermap::proof
