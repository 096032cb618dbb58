#include "tetra/detail/block_search.h"

#include <algorithm>
#include <queue>
#include <utility>

#include "innermap/core/run.h"
#include "tetra/detail/block_topology.h"

namespace innermap {
namespace {

constexpr double kThresholds[] = {0.5, 0.4, 0.3, 0.2, 0.1, 0.05};
constexpr int kShifts = 8;
// What is missed has to be drawn out of a flat side, what is too much only shrinks.
constexpr double kMissed = 1.5;
// Of each face of the boundary: without it, slanted surfaces become full of pits and bumps.
constexpr double kFace = 0.1;
constexpr double kLeastGain = 1e-9;  // over rounding

struct Lattice {
  BlockSet blocks;
  std::vector<double> shares;
};

int filledBeside(const BlockSet& blocks, const Block& b) {
  int count = 0;
  for (int a = 0; a < 3; ++a)
    for (int step = -1; step <= 1; step += 2) {
      Block beside = b;
      beside[a] += step;
      count += blocks.at(beside);
    }
  return count;
}

// What filling an empty block saves, or emptying a filled one. Not for the outermost layer.
double gainOf(const Lattice& l, std::size_t i) {
  const double share = l.shares[i];
  const double fill =
      kMissed * share - (1 - share) + kFace * (2 * filledBeside(l.blocks, l.blocks.block(i)) - 6);
  return l.blocks.filled[i] ? -fill : fill;
}

double costOf(const Lattice& l) {
  double sum = 0;
  for (std::size_t i = 0; i < l.shares.size(); ++i)
    sum += l.blocks.filled[i]
               ? 1 - l.shares[i] + kFace * (6 - filledBeside(l.blocks, l.blocks.block(i)))
               : kMissed * l.shares[i];
  return sum;
}

bool atRim(const BlockSet& blocks, const Block& b) {
  for (int a = 0; a < 3; ++a)
    if (b[a] == 0 || b[a] == blocks.size[a] - 1) return true;
  return false;
}

void keepLargestBody(BlockSet& blocks) {
  std::vector<int> labels;
  const int bodies = labelBlocks(blocks, true, labels);
  std::vector<std::size_t> sizes(static_cast<std::size_t>(bodies), 0);
  for (const int l : labels)
    if (l >= 0) ++sizes[l];
  const auto largest = std::max_element(sizes.begin(), sizes.end()) - sizes.begin();
  for (std::size_t i = 0; i < labels.size(); ++i)
    if (labels[i] != largest) blocks.filled[i] = 0;
}

void fillCavities(BlockSet& blocks) {
  std::vector<int> labels;
  labelBlocks(blocks, false, labels);
  for (std::size_t i = 0; i < labels.size(); ++i)
    if (labels[i] > 0) blocks.filled[i] = 1;  // 0: of the outermost layer
}

// At each place that is pinched the block is turned that costs least. Ends: a block is turned once.
void makeManifold(Lattice& l) {
  std::vector<char> turned(l.shares.size(), 0);
  for (bool again = true; again;) {
    again = false;
    for (int z = 1; z < l.blocks.size[2]; ++z)
      for (int y = 1; y < l.blocks.size[1]; ++y)
        for (int x = 1; x < l.blocks.size[0]; ++x) {
          if (manifoldAt(l.blocks, {x, y, z})) continue;
          std::size_t best = l.shares.size();
          double least = 0;
          for (int o = 0; o < 8; ++o) {
            const Block b{x - 1 + (o & 1), y - 1 + (o >> 1 & 1), z - 1 + (o >> 2)};
            const std::size_t i = l.blocks.index(b);
            if (turned[i] || atRim(l.blocks, b)) continue;
            const double cost = -gainOf(l, i);
            if (best < l.shares.size() && cost >= least) continue;
            best = i;
            least = cost;
          }
          if (best == l.shares.size()) continue;  // stays; the set will be found not manifold
          l.blocks.filled[best] ^= 1;
          turned[best] = again = true;
        }
  }
}

// Turns simple blocks, those that save most first, while any saves something. Each saves cost, so
// it ends.
void better(Lattice& l) {
  std::priority_queue<std::pair<double, std::size_t>> queue;
  const auto offer = [&](std::size_t i) {
    if (atRim(l.blocks, l.blocks.block(i))) return;
    const double gain = gainOf(l, i);
    if (gain > kLeastGain) queue.push({gain, i});
  };
  for (std::size_t i = 0; i < l.shares.size(); ++i) offer(i);
  while (!queue.empty()) {
    const std::size_t i = queue.top().second;
    queue.pop();
    const Block b = l.blocks.block(i);
    if (!(gainOf(l, i) > kLeastGain) || !isSimple(l.blocks, b)) continue;
    l.blocks.filled[i] ^= 1;
    for (int z = -1; z <= 1; ++z)
      for (int y = -1; y <= 1; ++y)
        for (int x = -1; x <= 1; ++x)
          if (x != 0 || y != 0 || z != 0) offer(l.blocks.index({b[0] + x, b[1] + y, b[2] + z}));
  }
}

bool fits(const Lattice& l, const std::vector<int>& handles) {
  return isManifold(l.blocks) && topologyOf(l.blocks).handles == handles;
}

// The best set of one shift.
std::optional<FoundBlocks> best(const BlockShares& shares, int shift,
                                const std::vector<int>& handles, bool grow) {
  std::optional<FoundBlocks> out;
  const auto consider = [&](Lattice& l) {
    if (!fits(l, handles)) return;
    better(l);
    const double cost = costOf(l) * l.blocks.edge * l.blocks.edge * l.blocks.edge;
    if (!out || cost < out->cost) out = FoundBlocks{l.blocks, l.shares, cost, shift, grow};
  };
  Lattice empty;
  empty.blocks = shares.lattice(shift);
  empty.shares = shares.shares(empty.blocks, shift);
  if (grow) {
    Lattice l = empty;
    const auto fullest = std::max_element(l.shares.begin(), l.shares.end()) - l.shares.begin();
    l.blocks.filled[static_cast<std::size_t>(fullest)] = 1;
    consider(l);
    return out;
  }
  for (const double threshold : kThresholds) {
    Lattice l = empty;
    for (std::size_t i = 0; i < l.shares.size(); ++i) l.blocks.filled[i] = l.shares[i] > threshold;
    if (l.blocks.count() == 0) continue;
    if (handles.size() == 1) fillCavities(l.blocks);
    makeManifold(l);
    keepLargestBody(l.blocks);
    if (handles.size() == 1) fillCavities(l.blocks);
    consider(l);
  }
  return out;
}

}  // namespace

std::optional<FoundBlocks> findBlocks(const BlockShares& shares, const std::vector<int>& handles) {
  std::optional<FoundBlocks> out;
  // Growth makes no handles and no cavities.
  const bool plain = handles == std::vector<int>{0};
  for (const bool grow : {false, true}) {
    if (grow && (out || !plain)) break;
    std::vector<std::optional<FoundBlocks>> found(kShifts);
    parallelBlocks(kShifts, 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t s = begin; s < end; ++s)
        found[s] = best(shares, static_cast<int>(s), handles, grow);
    });
    for (auto& f : found)
      if (f && (!out || f->cost < out->cost)) out = std::move(f);
  }
  return out;
}

}  // namespace innermap
