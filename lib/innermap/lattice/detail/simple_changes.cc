#include "innermap/lattice/detail/simple_changes.h"

#include <queue>
#include <utility>

namespace innermap {
namespace {

class SimpleChanges {
 public:
  SimpleChanges(LatticeSigns& signs, const Sides& wanted, NodeSide to,
                const std::vector<float>& order)
      : signs_(signs), wanted_(wanted), to_(to), order_(order), link_(BccLink::get()) {}

  void run(Progress* progress) {
    for (std::size_t node = 0; node < signs_.lattice.nodes(); ++node) push(node);
    std::size_t polled = 0;
    while (!queue_.empty()) {
      if (++polled % 65536 == 0) throwIfCancelled(progress);
      const std::size_t node = queue_.top().second;
      queue_.pop();
      if (signs_.side[node] == to_ || !simple(node)) continue;
      signs_.side[node] = to_;
      for (const std::ptrdiff_t offset : signs_.lattice.offsets(signs_.lattice.second(node)))
        push(node + static_cast<std::size_t>(offset));
    }
  }

 private:
  void push(std::size_t node) {
    if (wanted_[node] == to_ && signs_.side[node] != to_) queue_.push({order_[node], node});
  }

  bool simple(std::size_t node) const {
    int inside = 0;
    const auto& offsets = signs_.lattice.offsets(signs_.lattice.second(node));
    for (int d = 0; d < kDirections; ++d)
      inside |= (signs_.side[node + static_cast<std::size_t>(offsets[d])] == NodeSide::inside) << d;
    return link_.connected[inside] && link_.connected[inside ^ ((1 << kDirections) - 1)];
  }

  LatticeSigns& signs_;
  const Sides& wanted_;
  NodeSide to_;
  const std::vector<float>& order_;
  const BccLink& link_;
  std::priority_queue<std::pair<float, std::size_t>> queue_;
};

}  // namespace

void changeSimply(LatticeSigns& signs, const Sides& wanted, NodeSide to,
                  const std::vector<float>& order, Progress* progress) {
  SimpleChanges(signs, wanted, to, order).run(progress);
}

}  // namespace innermap
