// Disjoint sets of whole numbers that are united again and again (union-find).
#pragma once

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <vector>

namespace innermap {

// Paths are halved on the way (Tarjan and van Leeuwen, "Worst-Case Analysis of Set Union
// Algorithms", J. ACM 1984). A set's lowest member represents it, so results depend on no order.
class DisjointSets {
 public:
  // Sets of one member each: 0 to count - 1.
  explicit DisjointSets(std::size_t count) : parent_(count) {
    std::iota(parent_.begin(), parent_.end(), 0);
  }

  // The lowest member of i's set.
  int find(int i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }

  // Whether they were apart.
  bool unite(int i, int j) {
    i = find(i);
    j = find(j);
    parent_[std::max(i, j)] = std::min(i, j);
    return i != j;
  }

  // The lowest member of each one's set.
  std::vector<int> representatives() {
    std::vector<int> out(parent_.size());
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = find(static_cast<int>(i));
    return out;
  }

 private:
  std::vector<int> parent_;
};

}  // namespace innermap
