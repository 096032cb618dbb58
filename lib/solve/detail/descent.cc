#include "solve/detail/descent.h"

#include <memory>

#include "innermap/core/run.h"

namespace innermap {
namespace {

constexpr std::size_t kTasks = 256;  // subtrees that threads take, at least

struct Subtree {
  std::uint32_t root = 0;
  std::shared_ptr<const Expansion> parent;
  std::shared_ptr<const std::vector<std::uint32_t>> nodes;  // of charges not yet expanded
};

class Descent {
 public:
  Descent(const FarField& field, const BallTree& targets, const LeafVisitor& atLeaf)
      : field_(field), nodes_(targets.nodes()), atLeaf_(atLeaf) {}

  void run(std::string_view stage) {
    std::vector<Subtree> subtrees{
        {0, std::make_shared<Expansion>(), std::make_shared<std::vector<std::uint32_t>>(1, 0)}};
    while (subtrees.size() < kTasks && widen(subtrees)) {
    }
    parallelBlocks(
        subtrees.size(), 1,
        [&](std::size_t i, std::size_t) {
          DescentWorkspace work;
          visit(subtrees[i].root, *subtrees[i].parent, *subtrees[i].nodes, work);
        },
        stage);
  }

 private:
  // Replaces subtrees by those of their children; false when all are leaves.
  bool widen(std::vector<Subtree>& subtrees) const {
    std::vector<std::vector<Subtree>> parts(subtrees.size());
    parallelBlocks(subtrees.size(), 1, [&](std::size_t i, std::size_t) {
      const Subtree& s = subtrees[i];
      const BallTree::Node& node = nodes_[s.root];
      if (node.leaf()) {
        parts[i] = {s};
        return;
      }
      std::vector<std::uint32_t> left;
      FarFieldWorkspace work;
      const auto expansion = std::make_shared<const Expansion>(
          field_.expand(node.ball, *s.parent, *s.nodes, left, work));
      const auto shared = std::make_shared<const std::vector<std::uint32_t>>(std::move(left));
      for (std::uint32_t c = 0; c < node.children; ++c)
        parts[i].push_back({node.firstChild + c, expansion, shared});
    });
    const std::size_t before = subtrees.size();
    subtrees.clear();
    for (auto& p : parts) subtrees.insert(subtrees.end(), p.begin(), p.end());
    return subtrees.size() > before;
  }

  void visit(std::uint32_t n, const Expansion& parent, const std::vector<std::uint32_t>& nodes,
             DescentWorkspace& work) const {
    const BallTree::Node& node = nodes_[n];
    if (node.leaf()) {
      throwIfCancelled();
      atLeaf_(node, field_.expandLast(node.ball, parent, nodes, work.near, work.farField), work);
      return;
    }
    std::vector<std::uint32_t> left;
    const Expansion expansion = field_.expand(node.ball, parent, nodes, left, work.farField);
    for (std::uint32_t c = 0; c < node.children; ++c)
      visit(node.firstChild + c, expansion, left, work);
  }

  const FarField& field_;
  const std::vector<BallTree::Node>& nodes_;
  const LeafVisitor& atLeaf_;
};

}  // namespace

void descend(const FarField& field, const BallTree& targets, const LeafVisitor& visit,
             std::string_view stage) {
  if (!targets.empty()) Descent(field, targets, visit).run(stage);
}

}  // namespace innermap
