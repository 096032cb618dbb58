#include "lattice/lattice_signs.h"

#include <openvdb/tools/Dense.h>

#include <algorithm>
#include <cmath>

#include "innermap/core/run.h"
#include "innermap/levelset/level_set.h"

namespace innermap {
namespace {

constexpr int kPadding = 3;      // cells around the box
constexpr double kShift = 0.37;  // cells: keeps flat faces along the axes off the nodes

void fillDistances(const Solid& solid, LatticeSigns& signs, int second) {
  const BccLattice& lattice = signs.lattice;
  LevelSetSettings settings;
  settings.voxelSize = lattice.spacing();
  settings.halfWidth = 2;
  settings.origin = lattice.position(second ? lattice.cells() : 0);
  const openvdb::FloatGrid::Ptr grid = makeLevelSet(solid, settings);
  const auto& n = lattice.size();
  const openvdb::CoordBBox box(0, 0, 0, n[0] - 1, n[1] - 1, n[2] - 1);
  openvdb::tools::Dense<float, openvdb::tools::LayoutXYZ> dense(
      box, signs.distance.data() + (second ? lattice.cells() : 0));
  openvdb::tools::copyToDense(grid->tree(), dense);
}

// The sets of a node's neighbours that are inside, on the surface and outside.
struct Neighbours {
  int inside = 0, on = 0, outside = 0;
};

class Warper {
 public:
  explicit Warper(LatticeSigns& signs) : signs_(signs), link_(BccLink::get()) {}

  // The direction of the nearest cut that is too near, or -1.
  int nearestCut(std::size_t node) const {
    const NodeSide side = signs_.side[node];
    if (side == NodeSide::on) return -1;
    const auto& offsets = signs_.lattice.offsets(signs_.lattice.second(node));
    const double mine = std::abs(static_cast<double>(signs_.distance[node]));
    const bool genuine = (signs_.distance[node] < 0) == (side == NodeSide::inside);
    if (!genuine || mine >= signs_.lattice.spacing()) return -1;
    const NodeSide opposite = side == NodeSide::inside ? NodeSide::outside : NodeSide::inside;
    int best = -1;
    double nearest = 0;
    for (int d = 0; d < kDirections; ++d) {
      const std::size_t other = node + static_cast<std::size_t>(offsets[d]);
      if (signs_.side[other] != opposite) continue;
      if ((signs_.distance[other] < 0) != (opposite == NodeSide::inside)) continue;
      const double share =
          mine / std::max(mine + std::abs(static_cast<double>(signs_.distance[other])), 1e-300);
      if (share >= leastCut(d)) continue;
      const double length = share * signs_.lattice.length(d);
      if (best >= 0 && length >= nearest) continue;
      best = d;
      nearest = length;
    }
    return best;
  }

  void tryWarp(std::size_t node) {
    const int direction = nearestCut(node);
    if (direction < 0) return;
    const NodeSide before = signs_.side[node];
    signs_.side[node] = NodeSide::on;
    const Neighbours around = neighbours(node);
    bool good = manifoldAt(around);
    for (int d = 0; good && d < kDirections; ++d)
      if (around.on >> d & 1) {
        const Neighbours there = neighbours(signs_.lattice.neighbour(node, d));
        good = manifoldAt(there);
      }
    if (good)
      signs_.onEdge[node] = static_cast<std::int8_t>(direction);
    else
      signs_.side[node] = before;
  }

 private:
  Neighbours neighbours(std::size_t node) const {
    const auto& offsets = signs_.lattice.offsets(signs_.lattice.second(node));
    Neighbours n;
    for (int d = 0; d < kDirections; ++d) {
      const NodeSide side = signs_.side[node + static_cast<std::size_t>(offsets[d])];
      n.inside |= (side == NodeSide::inside) << d;
      n.on |= (side == NodeSide::on) << d;
      n.outside |= (side == NodeSide::outside) << d;
    }
    return n;
  }

  // Whether what is inside meets a node on the surface in a disk: then the node may go either way
  // without a change of topology.
  bool manifoldAt(const Neighbours& n) const {
    if (!n.outside || !link_.connected[n.inside] || !link_.connected[n.on | n.outside])
      return false;
    for (int d = 0; d < kDirections; ++d) {
      if (!(n.on >> d & 1)) continue;
      const std::vector<int>& ring = link_.around[d];
      int changes = 0, inside = 0;
      for (std::size_t k = 0; k < ring.size(); ++k) {
        const int here = n.inside >> ring[k] & 1;
        inside += here;
        changes += here != (n.inside >> ring[(k + 1) % ring.size()] & 1);
      }
      if (changes > 2 || inside == static_cast<int>(ring.size())) return false;
    }
    return true;
  }

  LatticeSigns& signs_;
  const BccLink& link_;
};

constexpr int kBlock = 8;  // cells; nodes of two blocks that are one apart never see each other

}  // namespace

LatticeSigns latticeSigns(const Solid& solid, double spacing) {
  const Box3& box = solid.box();
  std::array<int, 3> size{};
  for (int a = 0; a < 3; ++a)
    size[a] = static_cast<int>(std::ceil(box.extent()[a] / spacing + kShift)) + 2 * kPadding;
  const double before = (kPadding + kShift) * spacing;
  LatticeSigns signs;
  signs.lattice = BccLattice(box.lower - Vec3{before, before, before}, spacing, size);
  const std::size_t nodes = signs.lattice.nodes();
  signs.distance.resize(nodes);
  for (int second = 0; second < 2; ++second) fillDistances(solid, signs, second);
  signs.side.resize(nodes);
  signs.onEdge.assign(nodes, -1);
  parallelBlocks(nodes, 1 << 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n)
      signs.side[n] = signs.distance[n] < 0 ? NodeSide::inside : NodeSide::outside;
  });
  return signs;
}

double cutShare(const LatticeSigns& signs, std::size_t node, int direction) {
  const double a = static_cast<double>(signs.distance[node]);
  const double b = static_cast<double>(signs.distance[signs.lattice.neighbour(node, direction)]);
  if ((a < 0) != (b < 0)) return a / (a - b);
  // Both inside: the cut is pushed to the end that should be outside.
  const bool inside = signs.side[node] == NodeSide::inside;
  return (a < 0) == inside ? 1 : 0;
}

void warpNodes(LatticeSigns& signs) {
  const BccLattice& lattice = signs.lattice;
  std::array<int, 3> blocks{};
  for (int a = 0; a < 3; ++a) blocks[a] = (lattice.size()[a] + kBlock - 1) / kBlock;
  const std::size_t count = static_cast<std::size_t>(blocks[0]) * blocks[1] * blocks[2];
  Warper warper(signs);
  // Eight rounds; the blocks of one round stand apart, so that their order does not matter.
  for (int colour = 0; colour < 8; ++colour)
    parallelBlocks(count, 4, [&](std::size_t begin, std::size_t end) {
      for (std::size_t b = begin; b < end; ++b) {
        const std::array<int, 3> block{static_cast<int>(b % blocks[0]),
                                       static_cast<int>(b / blocks[0] % blocks[1]),
                                       static_cast<int>(b / blocks[0] / blocks[1])};
        if (((block[0] & 1) | (block[1] & 1) << 1 | (block[2] & 1) << 2) != colour) continue;
        std::array<int, 3> from{}, to{};
        for (int a = 0; a < 3; ++a) {
          from[a] = std::max(kBlock * block[a], 2);
          to[a] = std::min(kBlock * (block[a] + 1), lattice.size()[a] - 2);
        }
        const double near = lattice.spacing();
        for (int second = 0; second < 2; ++second)
          for (int k = from[2]; k < to[2]; ++k)
            for (int j = from[1]; j < to[1]; ++j)
              for (int i = from[0]; i < to[0]; ++i) {
                const std::size_t node =
                    (second ? lattice.cells() : 0) + i +
                    lattice.size()[0] * (j + lattice.size()[1] * static_cast<std::size_t>(k));
                if (std::abs(static_cast<double>(signs.distance[node])) < near)
                  warper.tryWarp(node);
              }
      }
    });
}

}  // namespace innermap
