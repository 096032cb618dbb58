#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>

#include "innermap/core/parallel.h"
#include "innermap/sample/neighbour_grid.h"
#include "innermap/sample/surface_samples.h"

namespace innermap {
namespace {

// Points by weight, the heaviest first; ties go to the lower index. Weights only fall, so a binary
// heap may keep the weight that a point had when it was last looked at: what stands on top with its
// present weight is the heaviest of all.
class LazyHeap {
 public:
  explicit LazyHeap(std::vector<double> weights) : weights_(std::move(weights)) {
    entries_.reserve(weights_.size());
    for (const double weight : weights_) {
      entries_.push_back({weight, static_cast<std::uint32_t>(entries_.size())});
    }
    for (std::size_t i = entries_.size() / 2; i-- > 0;) sink(i, entries_[i]);
  }

  bool contains(std::size_t i) const { return weights_[i] != kGone; }
  std::size_t size() const { return entries_.size(); }

  std::size_t pop() {
    for (;;) {
      const Entry top = entries_.front();
      const double weight = weights_[top.item];
      if (weight == top.weight) break;
      sink(0, {weight, top.item});
    }
    const std::uint32_t item = entries_.front().item;
    weights_[item] = kGone;
    const Entry last = entries_.back();
    entries_.pop_back();
    if (!entries_.empty()) sink(0, last);
    return item;
  }

  void lighten(std::size_t i, double by) { weights_[i] -= by; }

 private:
  // Weights are sums of terms in [0, 1], less what rounding leaves of them.
  static constexpr double kGone = -std::numeric_limits<double>::infinity();

  struct Entry {
    double weight;
    std::uint32_t item;

    bool before(const Entry& other) const {
      return weight > other.weight || (weight == other.weight && item < other.item);
    }
  };

  void sink(std::size_t at, const Entry entry) {
    for (;;) {
      std::size_t child = 2 * at + 1;
      if (child >= entries_.size()) break;
      if (child + 1 < entries_.size() && entries_[child + 1].before(entries_[child])) ++child;
      if (!entries_[child].before(entry)) break;
      entries_[at] = entries_[child];
      at = child;
    }
    entries_[at] = entry;
  }

  std::vector<double> weights_;
  std::vector<Entry> entries_;
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
  LazyHeap heap(std::move(weights));
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
