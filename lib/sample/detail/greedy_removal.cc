#include "sample/detail/greedy_removal.h"

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <functional>

#include "innermap/core/run.h"

namespace innermap {
namespace {

constexpr int kLog2Cube = 4;      // cells a side of the cubes that work for themselves
constexpr double kUnit = 0x1p40;  // of the whole numbers that weights are; sums stay below 2^63
constexpr double kStep = 0.75;    // from one threshold of weights to the next

using Weight = std::int64_t;
constexpr Weight kGone = -1;

// A point with the weight it had when it was last looked at.
struct Entry {
  Weight weight;
  std::uint32_t point;

  bool before(const Entry& other) const {
    return weight > other.weight || (weight == other.weight && point < other.point);
  }
};

struct Less {
  bool operator()(const Entry& x, const Entry& y) const { return y.before(x); }
};

// Puts `entry` in the place of the heap's top.
void replaceTop(std::vector<Entry>& heap, const Entry entry) {
  std::size_t at = 0;
  for (std::size_t child = 1; child < heap.size(); child = 2 * at + 1) {
    if (child + 1 < heap.size() && heap[child + 1].before(heap[child])) ++child;
    if (!heap[child].before(entry)) break;
    heap[at] = heap[child];
    at = child;
  }
  heap[at] = entry;
}

struct Cube {
  std::vector<Entry> heap;          // by weights that may have fallen since
  std::vector<Entry> aside;         // wait for a heavier neighbour in another cube
  std::vector<Entry> removed;       // with the weights they had
  std::vector<Entry> told;          // points of other cubes, and by how much they become lighter
  std::vector<std::uint32_t> edge;  // points with neighbours in other cubes
};

class Removal {
 public:
  Removal(const NeighbourGrid& grid, const NeighbourWeight& weight)
      : grid_(grid),
        weightOf_(weight),
        weight_(grid.size(), 0),
        shown_(grid.size()),
        cubeOf_(grid.size()) {
    const std::vector<std::vector<std::uint32_t>> groups = grid.cubes(kLog2Cube);
    cubes_.resize(groups.size());
    forCubes([&](std::size_t c) {
      for (const std::uint32_t cell : groups[c])
        for (std::uint32_t i = grid.cellStarts()[cell]; i < grid.cellStarts()[cell + 1]; ++i)
          cubeOf_[i] = static_cast<std::uint32_t>(c);
    });
    forCubes([&](std::size_t c) {
      for (const std::uint32_t cell : groups[c])
        for (std::uint32_t i = grid.cellStarts()[cell]; i < grid.cellStarts()[cell + 1]; ++i)
          weigh(cubes_[c], i);
      std::make_heap(cubes_[c].heap.begin(), cubes_[c].heap.end(), Less());
    });
  }

  std::vector<std::size_t> run(std::size_t count) {
    const std::size_t wanted = grid_.size() - count;
    Weight threshold = 0;
    for (const Cube& cube : cubes_)
      if (!cube.heap.empty()) threshold = std::max(threshold, cube.heap.front().weight);
    for (std::size_t gone = 0; gone < wanted;) {
      threshold = static_cast<Weight>(kStep * static_cast<double>(threshold));
      while (round(threshold)) continue;
      gone = 0;
      for (const Cube& cube : cubes_) gone += cube.removed.size();
      reportProgress("placing samples",
                     std::min(1.0, static_cast<double>(gone) / static_cast<double>(wanted)));
    }
    restoreLightest(wanted);
    std::vector<std::size_t> left;
    for (std::size_t i = 0; i < weight_.size(); ++i)
      if (weight_[i] != kGone) left.push_back(i);
    return left;
  }

 private:
  struct Neighbour {
    std::uint32_t point;
    Weight given;
  };

  void forCubes(const std::function<void(std::size_t)>& body) {
    parallelBlocks(cubes_.size(), 1, [&](std::size_t begin, std::size_t) { body(begin); });
  }

  Weight given(double squared) const { return static_cast<Weight>(kUnit * weightOf_(squared)); }

  void weigh(Cube& cube, std::uint32_t i) {
    Weight sum = 0;
    bool atEdge = false;
    grid_.forNeighbours(i, [&](std::size_t j, double squared) {
      sum += given(squared);
      atEdge |= cubeOf_[j] != cubeOf_[i];
    });
    weight_[i] = shown_[i] = sum;
    cube.heap.push_back({sum, i});
    if (atEdge) cube.edge.push_back(i);
  }

  // One round: all cubes remove what they may, as heavy as the threshold or heavier; then tell.
  // False when nothing was left to do.
  bool round(Weight threshold) {
    std::atomic<bool> any{false};
    forCubes([&](std::size_t c) {
      if (work(static_cast<std::uint32_t>(c), threshold)) any = true;
    });
    if (!any) return false;
    for (Cube& cube : cubes_) {
      for (const Entry& told : cube.told) weight_[told.point] -= told.weight;
      cube.told.clear();
    }
    forCubes([&](std::size_t c) {
      for (const std::uint32_t i : cubes_[c].edge) shown_[i] = weight_[i];
    });
    return true;
  }

  bool work(std::uint32_t c, Weight threshold) {
    Cube& cube = cubes_[c];
    bool any = false;
    std::vector<Neighbour> neighbours;
    while (!cube.heap.empty() && cube.heap.front().weight >= threshold) {
      const Entry top = cube.heap.front();
      if (weight_[top.point] != top.weight) {
        replaceTop(cube.heap, {weight_[top.point], top.point});
        continue;
      }
      const Entry last = cube.heap.back();
      cube.heap.pop_back();
      if (!cube.heap.empty()) replaceTop(cube.heap, last);
      any = true;
      if (isHeaviest(c, top, neighbours))
        remove(c, top, neighbours);
      else
        cube.aside.push_back(top);
    }
    for (const Entry& entry : cube.aside) {
      cube.heap.push_back(entry);
      std::push_heap(cube.heap.begin(), cube.heap.end(), Less());
    }
    cube.aside.clear();
    return any;
  }

  // Whether no neighbour is heavier; of those in other cubes, none was when the round began.
  bool isHeaviest(std::uint32_t c, const Entry& entry, std::vector<Neighbour>& neighbours) const {
    neighbours.clear();
    bool heaviest = true;
    grid_.forNeighbours(entry.point, [&](std::size_t j, double squared) {
      const Weight weight = cubeOf_[j] == c ? weight_[j] : shown_[j];
      if (weight == kGone) return;
      const auto point = static_cast<std::uint32_t>(j);
      if (Entry{weight, point}.before(entry)) heaviest = false;
      if (heaviest) neighbours.push_back({point, given(squared)});
    });
    return heaviest;
  }

  void remove(std::uint32_t c, const Entry& entry, const std::vector<Neighbour>& neighbours) {
    Cube& cube = cubes_[c];
    weight_[entry.point] = kGone;
    cube.removed.push_back(entry);
    for (const Neighbour& n : neighbours) {
      if (cubeOf_[n.point] == c)
        weight_[n.point] -= n.given;
      else
        cube.told.push_back({n.given, n.point});
    }
  }

  // One point after the other, those removed first would have been the heaviest.
  void restoreLightest(std::size_t wanted) {
    std::vector<Entry> removed;
    for (const Cube& cube : cubes_)
      removed.insert(removed.end(), cube.removed.begin(), cube.removed.end());
    const auto middle = removed.begin() + static_cast<std::ptrdiff_t>(wanted);
    std::nth_element(removed.begin(), middle, removed.end(),
                     [](const Entry& x, const Entry& y) { return x.before(y); });
    for (auto entry = middle; entry != removed.end(); ++entry) weight_[entry->point] = 0;
  }

  const NeighbourGrid& grid_;
  const NeighbourWeight& weightOf_;
  std::vector<Weight> weight_, shown_;  // shown_: to other cubes, as of the round's beginning
  std::vector<std::uint32_t> cubeOf_;
  std::vector<Cube> cubes_;
};

}  // namespace

std::vector<std::size_t> heaviestRemoved(const NeighbourGrid& grid, std::size_t count,
                                         const NeighbourWeight& weight) {
  return Removal(grid, weight).run(count);
}

}  // namespace innermap
