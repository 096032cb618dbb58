#include "lattice/detail/grow_solid.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "innermap/core/run.h"
#include "lattice/detail/lattice_topology.h"

namespace innermap {
namespace {

constexpr double kLeastPart = 1e-3;
// Cores: at each order along the sheets, which are below 0, to a thousandth; then every half
// spacing, then in equal steps.
constexpr float kFineSteps = 1000, kHalfSteps = 8;
constexpr int kFarSteps = 20;
constexpr std::size_t kMostCores = 60;  // evenly out of more

// The nodes of the lattice that can be reached from `out` over nodes for which `open` holds.
template <class Open>
std::vector<std::size_t> reached(const BccLattice& lattice, std::vector<std::size_t> out,
                                 const Open& open, std::vector<bool>& seen) {
  for (const std::size_t start : out) seen[start] = true;
  for (std::size_t k = 0; k < out.size(); ++k)
    for (int d = 0; d < kDirections; ++d) {
      const std::size_t next = lattice.neighbour(out[k], d);
      if (next >= seen.size() || seen[next] || !open(next)) continue;
      seen[next] = true;
      out.push_back(next);
    }
  return out;
}

// Whether the node stands far enough from the lattice's sides for all its neighbours to be nodes.
class Middle {
 public:
  explicit Middle(const BccLattice& lattice) : lattice_(lattice) {}

  bool operator()(std::size_t node) const {
    const auto& n = lattice_.size();
    std::size_t c = lattice_.second(node) ? node - lattice_.cells() : node;
    for (int a = 0; a < 3; ++a) {
      const auto i = static_cast<int>(c % n[a]);
      c /= static_cast<std::size_t>(n[a]);
      if (i < 1 || i > n[a] - 2) return false;
    }
    return true;
  }

 private:
  const BccLattice& lattice_;
};

Sides sidesOf(std::size_t nodes, const std::vector<std::size_t>& inside) {
  Sides sides(nodes, NodeSide::outside);
  for (const std::size_t n : inside) sides[n] = NodeSide::inside;
  return sides;
}

std::vector<float> coresOf(const Sides& part, const std::vector<float>& order) {
  std::vector<float> steps;
  float top = 0;
  for (std::size_t n = 0; n < part.size(); ++n) {
    if (part[n] != NodeSide::inside) continue;
    top = std::max(top, order[n]);
    if (order[n] < 0) steps.push_back(std::round(kFineSteps * order[n]) / kFineSteps);
  }
  for (float k = 0; k < 2 * kHalfSteps && 0.5f * k < top; ++k) steps.push_back(0.5f * k);
  for (int k = 1; k < kFarSteps && top > kHalfSteps; ++k)
    steps.push_back(kHalfSteps + (top - kHalfSteps) * static_cast<float>(k) / kFarSteps);
  std::sort(steps.begin(), steps.end());
  steps.erase(std::unique(steps.begin(), steps.end()), steps.end());
  if (steps.size() <= kMostCores) return steps;
  std::vector<float> some;
  for (std::size_t k = 0; k < kMostCores; ++k)
    some.push_back(steps[k * (steps.size() - 1) / (kMostCores - 1)]);
  return some;
}

}  // namespace

Sides nodesWithNeighbours(const BccLattice& lattice) {
  const Middle middle(lattice);
  Sides sides(lattice.nodes(), NodeSide::outside);
  for (std::size_t n = 0; n < sides.size(); ++n)
    if (middle(n)) sides[n] = NodeSide::inside;
  return sides;
}

void fillPockets(const BccLattice& lattice, Sides& sides) {
  const Middle middle(lattice);
  std::vector<bool> seen(sides.size(), false);
  const std::size_t corner =
      1 + lattice.size()[0] * (1 + static_cast<std::size_t>(lattice.size()[1]));
  reached(
      lattice, {corner}, [&](std::size_t n) { return sides[n] != NodeSide::inside && middle(n); },
      seen);
  for (std::size_t n = 0; n < sides.size(); ++n)
    sides[n] = seen[n] || !middle(n) ? NodeSide::outside : NodeSide::inside;
}

std::vector<std::vector<std::size_t>> piecesInside(const BccLattice& lattice, const Sides& sides) {
  std::vector<bool> seen(sides.size(), false);
  std::vector<std::vector<std::size_t>> found;
  for (std::size_t n = 0; n < sides.size(); ++n) {
    if (seen[n] || sides[n] != NodeSide::inside) continue;
    throwIfCancelled();
    found.push_back(reached(
        lattice, {n}, [&](std::size_t m) { return sides[m] == NodeSide::inside; }, seen));
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const auto& a, const auto& b) { return a.size() > b.size(); });
  return found;
}

SolidParts partsOf(const LatticeSigns& signs, bool onePiece) {
  const std::vector<std::vector<std::size_t>> found = piecesInside(signs.lattice, signs.side);
  SolidParts out;
  std::size_t all = 0, left = 0;
  for (const auto& nodes : found) {
    all += nodes.size();
    if ((onePiece && !out.parts.empty()) ||
        static_cast<double>(nodes.size()) < kLeastPart * static_cast<double>(found[0].size())) {
      ++out.leftOut;
      left += nodes.size();
      continue;
    }
    out.parts.push_back(sidesOf(signs.side.size(), nodes));
    fillPockets(signs.lattice, out.parts.back());
  }
  out.leftOutShare = all ? static_cast<double>(left) / static_cast<double>(all) : 0;
  return out;
}

namespace {

// Cores of a part without pockets. What is outside the part hangs together, so that pockets are
// found among the part's own nodes, few of the lattice's.
class Cores {
 public:
  Cores(const BccLattice& lattice, const Sides& part, const std::vector<float>& order)
      : lattice_(lattice), part_(part), order_(order) {
    for (std::size_t n = 0; n < part.size(); ++n) {
      if (!inPart(n)) continue;
      if (nodes_.empty() || order[n] > order[deepest_]) deepest_ = n;
      nodes_.push_back(n);
      for (int d = 0; d < kDirections; ++d)
        if (!inPart(lattice.neighbour(n, d))) {
          rim_.push_back(n);
          break;
        }
    }
  }

  std::size_t deepest() const { return deepest_; }

  // What hangs together with the deepest node over nodes of at least that order, pockets filled.
  Sides at(float least) const {
    std::vector<bool> seen(part_.size(), false);
    Sides sides = sidesOf(
        part_.size(), reached(
                          lattice_, {deepest_},
                          [&](std::size_t n) { return inPart(n) && order_[n] >= least; }, seen));
    const auto open = [&](std::size_t n) { return inPart(n) && sides[n] != NodeSide::inside; };
    std::vector<std::size_t> starts;
    std::copy_if(rim_.begin(), rim_.end(), std::back_inserter(starts), open);
    std::vector<bool> left(part_.size(), false);
    reached(lattice_, starts, open, left);
    for (const std::size_t n : nodes_)
      if (!left[n]) sides[n] = NodeSide::inside;
    return sides;
  }

 private:
  bool inPart(std::size_t n) const { return part_[n] == NodeSide::inside; }

  const BccLattice& lattice_;
  const Sides& part_;
  const std::vector<float>& order_;
  std::vector<std::size_t> nodes_, rim_;  // the part's; those beside a node outside it
  std::size_t deepest_ = 0;
};

// Whether each piece of the part that was not grown has a node on a buried sheet: a handle of the
// solid's own would be cut anywhere.
bool isCutAtSheets(const LatticeSigns& signs, const Sides& part, const std::vector<float>& order) {
  Sides cut = part;
  for (std::size_t n = 0; n < cut.size(); ++n)
    if (signs.side[n] == NodeSide::inside) cut[n] = NodeSide::outside;
  const auto pieces = piecesInside(signs.lattice, cut);
  return std::all_of(pieces.begin(), pieces.end(), [&](const std::vector<std::size_t>& piece) {
    return std::any_of(piece.begin(), piece.end(), [&](std::size_t n) { return order[n] < 0; });
  });
}

}  // namespace

bool growWithHandles(LatticeSigns& signs, const Sides& part, int handles,
                     const std::vector<float>& order) {
  const SolidTopology wanted{1, 0, handles};
  signs.side = part;
  if (latticeTopology(signs) == wanted) return true;
  const Cores cores(signs.lattice, part, order);
  const std::size_t deepest = cores.deepest();
  for (const float core : coresOf(part, order)) {
    throwIfCancelled();
    if (!(core <= order[deepest])) break;
    signs.side = cores.at(core);
    if (!(latticeTopology(signs) == wanted)) continue;
    changeSimply(signs, part, NodeSide::inside, order);
    return true;
  }
  if (handles == 0) {
    // A node has none, whatever the cores have.
    signs.side = sidesOf(part.size(), {deepest});
    changeSimply(signs, part, NodeSide::inside, order);
    if (isCutAtSheets(signs, part, order)) return true;
  }
  signs.side = part;
  return false;
}

}  // namespace innermap
