#include "sample/detail/sample_elimination.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "sample/detail/greedy_removal.h"
#include "sample/detail/neighbour_grid.h"

namespace innermap {
namespace {

// Points beyond what evenly spread ones would put into a cell are given up unseen, or points that
// pile up would cost the square of their number. Keeps at least `count`, and just so many where
// that takes piles.
std::vector<std::size_t> withoutPiles(const NeighbourGrid& grid, std::size_t count) {
  constexpr std::size_t kPile = 256;
  const std::vector<std::uint32_t>& starts = grid.cellStarts();
  const auto keptWith = [&](std::size_t cap) {
    std::size_t kept = 0;
    for (std::size_t c = 0; c + 1 < starts.size(); ++c) {
      kept += std::min<std::size_t>(cap, starts[c + 1] - starts[c]);
    }
    return kept;
  };
  std::size_t cap = kPile;
  if (keptWith(cap) < count) {
    std::size_t upper = grid.size();  // keeps all
    while (cap + 1 < upper) {
      const std::size_t middle = cap + (upper - cap) / 2;
      (keptWith(middle) < count ? cap : upper) = middle;
    }
    cap = upper;
  }
  std::vector<std::size_t> kept;
  for (std::size_t c = 0; c + 1 < starts.size(); ++c) {
    const std::size_t size = std::min<std::size_t>(cap, starts[c + 1] - starts[c]);
    for (std::size_t i = 0; i < size; ++i) kept.push_back(grid.index(starts[c] + i));
  }
  std::sort(kept.begin(), kept.end());
  if (cap > kPile) kept.resize(count);
  return kept;
}

// Largest radius that `count` discs can have on the area (hexagonal packing). Without a sensible
// area, that of a curve as long as the points spread.
double largestRadius(const Points& points, std::size_t count, double area) {
  const double n = static_cast<double>(count);
  const double spread = boundingBox(points).diagonal();
  if (area > 0 && std::isfinite(area)) return std::sqrt(area / (2 * std::sqrt(3.0) * n));
  return 0.5 * spread / n;
}

std::vector<std::size_t> thin(const NeighbourGrid& grid, std::size_t count, double radius) {
  // Yuksel's weight limiting, gamma = 1.5 and beta = 0.65.
  const double ratio = static_cast<double>(count) / static_cast<double>(grid.size());
  const NeighbourWeight weight{2 * radius, 2 * radius * (1 - std::pow(ratio, 1.5)) * 0.65};
  std::vector<std::size_t> kept;
  kept.reserve(count);
  for (const std::size_t i : heaviestRemoved(grid, count, weight)) kept.push_back(grid.index(i));
  return kept;
}

}  // namespace

std::vector<std::size_t> eliminateSamples(const Points& points, std::size_t count, double area) {
  std::vector<std::size_t> all(points.size());
  std::iota(all.begin(), all.end(), std::size_t(0));
  if (count >= points.size()) return all;
  if (count == 0) return {};
  const double radius = largestRadius(points, count, area);
  if (!(radius > 0)) {  // all at one point
    all.resize(count);
    return all;
  }
  const NeighbourGrid grid(points, 2 * radius);
  std::vector<std::size_t> kept;
  const std::vector<std::size_t> spread = withoutPiles(grid, count);
  if (spread.size() == count) {
    kept = spread;
  } else if (spread.size() == points.size()) {
    kept = thin(grid, count, radius);
  } else {
    Points fewer;
    fewer.reserve(spread.size());
    for (const std::size_t i : spread) fewer.push_back(points[i]);
    for (const std::size_t i : thin(NeighbourGrid(fewer, 2 * radius), count, radius)) {
      kept.push_back(spread[i]);
    }
  }
  std::sort(kept.begin(), kept.end());
  return kept;
}

}  // namespace innermap
