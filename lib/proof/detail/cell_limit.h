// How many cells and pieces of triangles a proof may look at.
#pragma once

#include <algorithm>
#include <cstdint>

#include "innermap/proof/prove.h"

namespace innermap::proof {

// Of the boundary: what takes more than cells do.
constexpr std::uint64_t kBytesPerPiece = 400;

// Steps of a map from which on cells are fewer, by the square: each takes time in proportion to the
// steps, and as what is known of it spreads with each step, less of them is proven. Of a map in 44
// steps eight cells a charge proved 46% of the solid in 37 s, eight steps' share of them nothing.
constexpr double kManySteps = 8;

inline std::uint64_t cellLimit(const ComposedMap& map, const ProofSettings& settings) {
  const double share = std::min(1.0, kManySteps / static_cast<double>(map.steps().size()));
  const double cells = share * share * settings.cellsPerCharge * static_cast<double>(map.sources());
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
