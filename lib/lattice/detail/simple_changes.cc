#include "lattice/detail/simple_changes.h"

#include <queue>
#include <utility>

#include "innermap/core/run.h"

namespace innermap {
namespace {

// Of nodes that have the side `to` in one place around them; simple: and the other side too.
class Changes {
 public:
  Changes(LatticeSigns& signs, const Sides& wanted, NodeSide to, const std::vector<float>& order,
          bool simple)
      : signs_(signs),
        wanted_(wanted),
        to_(to),
        order_(order),
        simple_(simple),
        link_(BccLink::get()) {}

  void run() {
    for (std::size_t node = 0; node < signs_.lattice.nodes(); ++node) push(node);
    std::size_t polled = 0;
    while (!queue_.empty()) {
      if (++polled % 65536 == 0) throwIfCancelled();
      const std::size_t node = queue_.top().second;
      queue_.pop();
      if (signs_.side[node] == to_ || !possible(node)) continue;
      signs_.side[node] = to_;
      for (const std::ptrdiff_t offset : signs_.lattice.offsets(signs_.lattice.second(node)))
        push(node + static_cast<std::size_t>(offset));
    }
  }

 private:
  void push(std::size_t node) {
    if (wanted_[node] == to_ && signs_.side[node] != to_) queue_.push({order_[node], node});
  }

  bool possible(std::size_t node) const {
    int there = 0;
    const auto& offsets = signs_.lattice.offsets(signs_.lattice.second(node));
    for (int d = 0; d < kDirections; ++d)
      there |= (signs_.side[node + static_cast<std::size_t>(offsets[d])] == to_) << d;
    return link_.connected[there] &&
           (!simple_ || link_.connected[there ^ ((1 << kDirections) - 1)]);
  }

  LatticeSigns& signs_;
  const Sides& wanted_;
  NodeSide to_;
  const std::vector<float>& order_;
  bool simple_;
  const BccLink& link_;
  std::priority_queue<std::pair<float, std::size_t>> queue_;
};

}  // namespace

void changeSimply(LatticeSigns& signs, const Sides& wanted, NodeSide to,
                  const std::vector<float>& order) {
  Changes(signs, wanted, to, order, true).run();
}

void changeWithoutPiercing(LatticeSigns& signs, const Sides& wanted, NodeSide to,
                           const std::vector<float>& order) {
  Changes(signs, wanted, to, order, false).run();
}

}  // namespace innermap
