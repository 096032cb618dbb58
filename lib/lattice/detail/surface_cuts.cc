#include "lattice/detail/surface_cuts.h"

#include <algorithm>
#include <array>

#include "innermap/core/run.h"
#include "innermap/core/vec3.h"
#include "lattice/detail/grow_solid.h"

namespace innermap {
namespace {

// Spacings from a cut's nodes to its walls: where it comes to the surface, more for each spacing of
// its depth, and at most. Measured with maps of solids with limbs bent through their bodies:
// narrower or thinner-skinned cuts make the steps of a map miss their tolerance.
constexpr double kMouth = 1.2, kSlope = 1, kWidest = 6;
// Nodes of the walls that stay inside, since the topology asks for them, are at least so deep.
constexpr float kLeastDepth = 0.1f;  // spacings

// How far each node lies within balls about others, in spacings; negative: how far from them.
class Balls {
 public:
  explicit Balls(const LatticeSigns& signs) : signs_(signs), within_(signs.side.size(), -kFar) {}

  // radius: spacings, at most kWidest.
  void add(std::size_t centre, double radius) {
    const BccLattice& lattice = signs_.lattice;
    const auto& n = lattice.size();
    const std::array<int, 3> at = placeOf(centre);
    std::array<int, 3> low, high;
    for (int a = 0; a < 3; ++a) {
      low[a] = std::max(2, at[a] - kReach);
      high[a] = std::min(n[a] - 3, at[a] + kReach);
    }
    const Vec3 middle = lattice.position(centre);
    for (int z = low[2]; z <= high[2]; ++z)
      for (int y = low[1]; y <= high[1]; ++y)
        for (int x = low[0]; x <= high[0]; ++x) {
          const auto node =
              static_cast<std::size_t>(x + n[0] * (y + static_cast<std::ptrdiff_t>(n[1]) * z));
          addTo(node, middle, radius);
          addTo(node + lattice.cells(), middle, radius);
        }
  }

  const std::vector<float>& within() const { return within_; }

 private:
  static constexpr int kReach = static_cast<int>(kWidest) + 1;
  static constexpr float kFar = 1e30f;

  std::array<int, 3> placeOf(std::size_t node) const {
    const auto& n = signs_.lattice.size();
    const auto c = static_cast<std::ptrdiff_t>(node % signs_.lattice.cells());
    return {static_cast<int>(c % n[0]), static_cast<int>(c / n[0] % n[1]),
            static_cast<int>(c / n[0] / n[1])};
  }

  void addTo(std::size_t node, const Vec3& centre, double radius) {
    const double away = norm(signs_.lattice.position(node) - centre) / signs_.lattice.spacing();
    within_[node] = std::max(within_[node], static_cast<float>(radius - away));
  }

  const LatticeSigns& signs_;
  std::vector<float> within_;
};

}  // namespace

std::vector<std::size_t> cutNodes(const Sides& all, const LatticeSigns& signs) {
  std::vector<std::size_t> cut;
  for (std::size_t n = 0; n < all.size(); ++n)
    if (all[n] == NodeSide::inside && signs.side[n] != NodeSide::inside) cut.push_back(n);
  return cut;
}

std::vector<Box3> boxesOf(const std::vector<std::size_t>& of, const LatticeSigns& signs) {
  Sides alone(signs.side.size(), NodeSide::outside);
  for (const std::size_t n : of) alone[n] = NodeSide::inside;
  std::vector<Box3> boxes;
  for (const std::vector<std::size_t>& nodes : piecesInside(signs.lattice, alone)) {
    boxes.emplace_back();
    for (const std::size_t n : nodes) boxes.back().add(signs.lattice.position(n));
  }
  return boxes;
}

void openCuts(const std::vector<std::size_t>& cut, const std::vector<float>& depth,
              LatticeSigns& signs) {
  if (cut.empty()) return;
  Balls opened(signs);
  for (std::size_t k = 0; k < cut.size(); ++k) {
    if (k % 256 == 0)
      reportProgress("opening the cuts", static_cast<double>(k) / static_cast<double>(cut.size()));
    opened.add(cut[k], std::min(kMouth + kSlope * static_cast<double>(depth[cut[k]]), kWidest));
  }
  const std::vector<float>& within = opened.within();
  Sides wanted(signs.side.size(), NodeSide::inside);
  for (std::size_t n = 0; n < wanted.size(); ++n)
    if (within[n] >= 0) wanted[n] = NodeSide::outside;
  changeSimply(signs, wanted, NodeSide::outside, within);
  const auto spacing = static_cast<float>(signs.lattice.spacing());
  for (std::size_t n = 0; n < within.size(); ++n) {
    const bool inside = signs.side[n] == NodeSide::inside;
    const float open = inside ? std::min(within[n], -kLeastDepth) : within[n];
    signs.distance[n] = std::max(signs.distance[n], spacing * open);
  }
}

void thickenPlugs(const std::vector<std::size_t>& plugs, const std::vector<std::size_t>& keptOut,
                  LatticeSigns& signs) {
  if (plugs.empty()) return;
  Balls thick(signs);
  for (const std::size_t n : plugs) thick.add(n, kMouth);
  const std::vector<float>& within = thick.within();
  Sides wanted(signs.side.size(), NodeSide::outside);
  for (std::size_t n = 0; n < wanted.size(); ++n)
    if (within[n] >= 0) wanted[n] = NodeSide::inside;
  for (const std::size_t n : keptOut) wanted[n] = NodeSide::outside;
  changeSimply(signs, wanted, NodeSide::inside, within);
  const auto spacing = static_cast<float>(signs.lattice.spacing());
  for (std::size_t n = 0; n < within.size(); ++n) {
    const bool inside = signs.side[n] == NodeSide::inside;
    const float closed = inside ? within[n] : std::min(within[n], -kLeastDepth);
    signs.distance[n] = std::min(signs.distance[n], -spacing * closed);
  }
}

}  // namespace innermap
