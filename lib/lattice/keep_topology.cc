#include "lattice/keep_topology.h"

#include <optional>

#include "innermap/core/run.h"
#include "lattice/detail/lattice_topology.h"
#include "lattice/detail/simple_changes.h"
#include "lattice/detail/thin_parts.h"

namespace innermap {
namespace {

Sides sidesBelow(const LatticeSigns& signs, double level) {
  Sides sides(signs.side.size());
  parallelBlocks(sides.size(), 1 << 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n)
      sides[n] =
          static_cast<double>(signs.distance[n]) < level ? NodeSide::inside : NodeSide::outside;
  });
  return sides;
}

std::size_t differing(const Sides& a, const Sides& b) {
  std::size_t count = 0;
  for (std::size_t n = 0; n < a.size(); ++n) count += a[n] != b[n];
  return count;
}

int complexity(const SolidTopology& t) { return t.components + t.cavities + t.handles; }

class TopologyKeeper {
 public:
  TopologyKeeper(const SolidTopology& wanted, LatticeSigns& signs, const ThinParts& parts)
      : wanted_(wanted), signs_(signs), parts_(parts), plain_(signs.side) {}

  // Walls that are lost are worse than a cut at an unlucky place.
  bool run() {
    if (rightWith(true, true)) return true;
    desired_ = signs_.side;
    if (rightWith(true, false)) return true;
    for (const double level : {0.15, 0.3, 0.6, 1.0, 1.5, 1.9}) {
      tryFrom(-level, NodeSide::inside);
      tryFrom(level, NodeSide::outside);
    }
    if (best_) signs_.side = *best_;
    return best_ || rightWith(false, true) || rightWith(false, false);
  }

 private:
  bool right() const { return latticeTopology(signs_) == wanted_; }

  bool rightWith(bool walls, bool gaps) {
    signs_.side = plain_;
    if (walls)
      for (const std::size_t node : parts_.walls) signs_.side[node] = NodeSide::inside;
    if (gaps)
      for (const std::size_t node : parts_.gaps) signs_.side[node] = NodeSide::outside;
    return right();
  }

  // From the nodes below `level` to those that are desired.
  void tryFrom(double level, NodeSide to) {
    throwIfCancelled();
    signs_.side = sidesBelow(signs_, level * signs_.lattice.spacing());
    // Growing adds to what is desired anyway, thinning takes away from more.
    for (std::size_t n = 0; n < desired_.size(); ++n)
      if (desired_[n] != to) signs_.side[n] = desired_[n];
    if (!right()) return;
    std::vector<float> order = signs_.distance;
    if (to == NodeSide::inside)
      for (float& distance : order) distance = -distance;
    changeSimply(signs_, desired_, to, order);
    const std::size_t changed = differing(signs_.side, desired_);
    if (best_ && changed >= leastChanged_) return;
    best_ = signs_.side;
    leastChanged_ = changed;
  }

  const SolidTopology& wanted_;
  LatticeSigns& signs_;
  const ThinParts& parts_;
  const Sides plain_;
  Sides desired_;
  std::optional<Sides> best_;
  std::size_t leastChanged_ = 0;
};

}  // namespace

KeptTopology keepTopology(const Solid& solid, const SolidTopology* wanted, LatticeSigns& signs) {
  const ThinParts parts = thinParts(solid, signs);
  const Sides plain = signs.side;
  KeptTopology result;
  if (wanted) {
    TopologyKeeper(*wanted, signs, parts).run();
  } else {
    const SolidTopology before = latticeTopology(signs);
    for (const std::size_t node : parts.walls) signs.side[node] = NodeSide::inside;
    if (complexity(latticeTopology(signs)) > complexity(before)) signs.side = plain;
  }
  result.found = latticeTopology(signs);
  result.kept = wanted && result.found == *wanted;
  result.changed = differing(plain, signs.side);
  result.points = parts.points;
  result.lost = parts.lost > 0 || result.changed > 0 ? thinParts(solid, signs).lost : 0;
  return result;
}

}  // namespace innermap
