#include "proof/detail/descent.h"

#include <algorithm>
#include <unordered_set>

#include "innermap/core/run.h"

namespace innermap::proof {
namespace {

// Of the expansions that are kept between levels.
constexpr std::size_t kBytesKept = 192u << 20;

}  // namespace

// The groups on the way to a node, by the level of their parents, and one expansion of each.
struct Descent::Path {
  struct Level {
    NodeKey groupOf = 0, node = 0;
    SetGroup group;
    StepExpansions expansions;  // of `node`, a child of `groupOf`
  };
  std::vector<Level> levels = std::vector<Level>(kMostLevels + 2);
  LaneSets sets;
};

Descent::Descent(const MapSteps& map, Splitter& splitter)
    : map_(map), splitter_(splitter), kept_{map.start()} {}

std::uint64_t Descent::memory(const MapSteps& map) {
  std::uint64_t bytes = 2 * kBytesKept;
  for (std::size_t k = 0; k < map.count(); ++k) bytes += 64 * map.start()[k]->near.size();
  return bytes;
}

std::size_t Descent::bytesKept() const {
  std::unordered_set<const StepExpansion*> seen;
  std::size_t bytes = 0;
  for (const StepExpansions& node : kept_)
    for (const auto& step : node)
      if (seen.insert(step.get()).second)
        bytes += sizeof(StepExpansion) + 8 * step->coefficients.size() + 4 * step->near.size();
  return bytes;
}

bool Descent::keepsChildren(std::size_t open) const {
  return 8 * open * (bytesKept() / std::max<std::size_t>(1, kept_.size())) <= kBytesKept;
}

StepExpansions Descent::expansionsOf(NodeKey key, int level, Path& path) const {
  if (level == keptLevel_)
    return kept_[std::lower_bound(keptKeys_.begin(), keptKeys_.end(), key) - keptKeys_.begin()];
  Path::Level& here = path.levels[level];
  if (here.node == key) return here.expansions;
  const NodeKey parentKey = key >> 3;
  const StepExpansions parent = expansionsOf(parentKey, level - 1, path);
  if (here.groupOf != parentKey) {
    splitter_.sets(parentKey, path.sets);
    here.group.compute(map_, parent, path.sets, 0xff, GroupUse::children);
    here.groupOf = parentKey;
  }
  here.expansions = here.group.child(parent, static_cast<int>(key & 7));
  here.node = key;
  return here.expansions;
}

void Descent::splitBlock(const std::vector<OpenNode>& open, std::size_t block, bool keep,
                         BlockResult& result) const {
  Path path;
  SetGroup group;
  const int level = levelOf(open.front().key);
  const std::size_t end = std::min(open.size(), (block + 1) * kBlock);
  for (std::size_t i = block * kBlock; i < end; ++i) {
    throwIfCancelled();
    const OpenNode& node = open[i];
    const ChildLanes lanes = splitter_.children(node);
    if (lanes.alive == 0) continue;
    const StepExpansions parent = expansionsOf(node.key, level, path);
    splitter_.sets(node.key, path.sets);
    group.compute(map_, parent, path.sets, lanes.alive, keep ? GroupUse::both : GroupUse::test);
    const std::uint8_t left = splitter_.decide(block, node, lanes, group);
    for (int lane = 0; lane < static_cast<int>(kLanes); ++lane) {
      if (!(left >> lane & 1)) continue;
      result.open.push_back({childOf(node.key, lane), (lanes.inside >> lane & 1) != 0});
      if (keep) result.expansions.push_back(group.child(parent, lane));
    }
  }
}

std::vector<OpenNode> Descent::split(const std::vector<OpenNode>& open) {
  if (open.empty()) return {};
  const bool keep = levelOf(open.front().key) == keptLevel_ && keepsChildren(open.size());
  std::vector<BlockResult> results((open.size() + kBlock - 1) / kBlock);
  parallelBlocks(results.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t block = begin; block < end; ++block)
      splitBlock(open, block, keep, results[block]);
  });
  std::vector<OpenNode> next;
  for (const BlockResult& r : results) next.insert(next.end(), r.open.begin(), r.open.end());
  if (keep) {
    keptKeys_.clear();
    kept_.clear();
    for (const OpenNode& node : next) keptKeys_.push_back(node.key);
    for (BlockResult& r : results)
      std::move(r.expansions.begin(), r.expansions.end(), std::back_inserter(kept_));
    ++keptLevel_;
  }
  return next;
}

}  // namespace innermap::proof
