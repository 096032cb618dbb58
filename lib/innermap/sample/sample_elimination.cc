#include <algorithm>
#include <cmath>
#include <numeric>

#include "innermap/core/parallel.h"
#include "innermap/sample/neighbour_grid.h"
#include "innermap/sample/surface_samples.h"

namespace innermap {
namespace {

// Binary heap of points by weight, the heaviest on top; ties go to the lower index. Weights only
// fall.
class Heap {
 public:
  explicit Heap(std::vector<double> weights) : weights_(std::move(weights)) {
    order_.resize(weights_.size());
    place_.resize(weights_.size());
    std::iota(order_.begin(), order_.end(), 0u);
    std::iota(place_.begin(), place_.end(), 0u);
    for (std::size_t i = order_.size() / 2; i-- > 0;) sink(i);
  }

  bool contains(std::size_t i) const { return place_[i] != kGone; }
  std::size_t size() const { return order_.size(); }

  std::size_t pop() {
    const std::uint32_t top = order_.front();
    place_[top] = kGone;
    const std::uint32_t last = order_.back();
    order_.pop_back();
    if (!order_.empty()) {
      order_[0] = last;
      place_[last] = 0;
      sink(0);
    }
    return top;
  }

  void lighten(std::size_t i, double by) {
    weights_[i] -= by;
    sink(place_[i]);
  }

 private:
  static constexpr std::uint32_t kGone = 0xffffffff;

  bool before(std::uint32_t i, std::uint32_t j) const {
    return weights_[i] > weights_[j] || (weights_[i] == weights_[j] && i < j);
  }

  void sink(std::size_t at) {
    const std::uint32_t item = order_[at];
    for (;;) {
      std::size_t child = 2 * at + 1;
      if (child >= order_.size()) break;
      if (child + 1 < order_.size() && before(order_[child + 1], order_[child])) ++child;
      if (!before(order_[child], item)) break;
      order_[at] = order_[child];
      place_[order_[at]] = static_cast<std::uint32_t>(at);
      at = child;
    }
    order_[at] = item;
    place_[item] = static_cast<std::uint32_t>(at);
  }

  std::vector<double> weights_;
  std::vector<std::uint32_t> order_, place_;
};

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

std::vector<std::size_t> thin(const NeighbourGrid& grid, std::size_t count, double radius,
                              Progress* progress) {
  const std::size_t n = grid.size();
  // Yuksel's weight limiting, gamma = 1.5 and beta = 0.65.
  const double ratio = static_cast<double>(count) / static_cast<double>(n);
  const double smallest = 2 * radius * (1 - std::pow(ratio, 1.5)) * 0.65;
  const double inverse = 1 / (2 * radius);
  const auto weight = [&](double squared) {
    const double d = std::max(std::sqrt(squared), smallest) * inverse;
    const double one = 1 - std::min(d, 1.0), two = one * one, four = two * two;
    return four * four;
  };
  std::vector<double> weights(n, 0.0);
  parallelBlocks(
      n, 1024,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
          grid.forNeighbours(i,
                             [&](std::size_t, double squared) { weights[i] += weight(squared); });
        }
      },
      progress);
  Heap heap(std::move(weights));
  while (heap.size() > count) {
    if (heap.size() % 4096 == 0) {
      reportProgress(progress, "placing samples",
                     static_cast<double>(n - heap.size()) / static_cast<double>(n - count));
    }
    const std::size_t gone = heap.pop();
    grid.forNeighbours(gone, [&](std::size_t j, double squared) {
      if (heap.contains(j)) heap.lighten(j, weight(squared));
    });
  }
  std::vector<std::size_t> kept;
  kept.reserve(count);
  for (std::size_t i = 0; i < n; ++i) {
    if (heap.contains(i)) kept.push_back(grid.index(i));
  }
  return kept;
}

}  // namespace

std::vector<std::size_t> eliminateSamples(const Points& points, std::size_t count, double area,
                                          Progress* progress) {
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
    kept = thin(grid, count, radius, progress);
  } else {
    Points fewer;
    fewer.reserve(spread.size());
    for (const std::size_t i : spread) fewer.push_back(points[i]);
    for (const std::size_t i : thin(NeighbourGrid(fewer, 2 * radius), count, radius, progress)) {
      kept.push_back(spread[i]);
    }
  }
  std::sort(kept.begin(), kept.end());
  return kept;
}

}  // namespace innermap
