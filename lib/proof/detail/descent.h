// Down a tree with eight children a node, level by level.
//
// A node's expansions are its parent's, moved. They are kept for the upper levels only; for lower
// ones each thread follows the path down to the nodes that it splits, which are neighbours. So
// memory stays small, and a limit on nodes cuts all places at the same level.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "proof/detail/map_steps.h"

namespace innermap::proof {

// A node by its path: 1, then three bits a level.
using NodeKey = std::uint64_t;
constexpr int kMostLevels = 20;

inline NodeKey childOf(NodeKey key, int lane) { return key << 3 | static_cast<NodeKey>(lane); }
inline int levelOf(NodeKey key) {
  int level = 0;
  while (key >>= 3) ++level;
  return level;
}

struct OpenNode {
  NodeKey key = 1;
  bool inside = false;  // as the splitter wants it
};

struct ChildLanes {
  std::uint8_t alive = 0, inside = 0;
};

// What is split, and into what. Called from several threads.
class Splitter {
 public:
  virtual ~Splitter() = default;
  // The children that matter.
  virtual ChildLanes children(const OpenNode& parent) const = 0;
  // The sets of all eight; those that do not matter may be anything.
  virtual void sets(NodeKey parent, LaneSets& out) const = 0;
  // The lanes to be split further. Blocks are numbered in the order of their nodes.
  virtual std::uint8_t decide(std::size_t block, const OpenNode& parent, const ChildLanes& lanes,
                              const SetGroup& group) = 0;
};

class Descent {
 public:
  // Nodes that one thread takes at a time.
  static constexpr std::size_t kBlock = 48;

  Descent(const MapSteps& map, Splitter& splitter);

  // Splits these nodes, sorted and all of one level, on all threads: the open children, sorted.
  // Levels have to follow one another from the root. Throws Cancelled.
  std::vector<OpenNode> split(const std::vector<OpenNode>& open);

  // Bytes at most, beside the map's own.
  static std::uint64_t memory(const MapSteps& map);

 private:
  struct Path;
  struct BlockResult {
    std::vector<OpenNode> open;
    std::vector<StepExpansions> expansions;
  };
  void splitBlock(const std::vector<OpenNode>& open, std::size_t block, bool keep,
                  BlockResult& result) const;
  StepExpansions expansionsOf(NodeKey key, int level, Path& path) const;
  bool keepsChildren(std::size_t open) const;
  std::size_t bytesKept() const;

  const MapSteps& map_;
  Splitter& splitter_;
  int keptLevel_ = 0;
  std::vector<NodeKey> keptKeys_{1};
  std::vector<StepExpansions> kept_;
};

}  // namespace innermap::proof
