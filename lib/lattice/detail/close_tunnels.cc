#include "lattice/detail/close_tunnels.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <set>
#include <utility>

#include "innermap/core/run.h"
#include "lattice/detail/grow_solid.h"
#include "lattice/detail/inside_distances.h"
#include "lattice/detail/lattice_topology.h"
#include "lattice/detail/surface_cuts.h"
#include "mesh/winding_number.h"

namespace innermap {
namespace {

constexpr std::size_t kMostTried = 24;  // each may cost a growth of the part
constexpr int kNearby = 4;              // edges from a tunnel's end to what is turned inside out

using Nodes = std::vector<std::size_t>;

// The sets across all tunnels, the smallest first.
std::vector<Nodes> plugs(const LatticeSigns& signs, const Sides& part) {
  constexpr float kFar = std::numeric_limits<float>::max();
  LatticeSigns around = signs;
  const Sides all = nodesWithNeighbours(signs.lattice);
  std::vector<float> near(part.size(), kFar);
  for (std::size_t n = 0; n < part.size(); ++n) {
    const bool open = all[n] == NodeSide::inside && part[n] != NodeSide::inside;
    around.side[n] = open ? NodeSide::inside : NodeSide::outside;
    for (int d = 0; open && d < kDirections; ++d)
      if (part[signs.lattice.neighbour(n, d)] == NodeSide::inside) near[n] = 0;
  }
  const std::vector<float> away = distancesInside(around, std::move(near));
  around.side = all;
  changeSimply(around, part, NodeSide::outside, away);
  for (std::size_t n = 0; n < part.size(); ++n)
    if (part[n] == NodeSide::inside) around.side[n] = NodeSide::outside;
  std::vector<Nodes> found = piecesInside(signs.lattice, around.side);
  std::reverse(found.begin(), found.end());
  return found;
}

class Tunnels {
 public:
  // with: the part alone, with so many handles.
  Tunnels(const Solid& solid, const LatticeSigns& signs, const Sides& part, const Sides& all,
          int handles, const std::vector<float>& order, LatticeSigns with, int has)
      : signs_(signs),
        part_(part),
        all_(all),
        handles_(handles),
        order_(order),
        winding_(solid.repaired().mesh.vertices, solid.repaired().mesh.triangles),
        with_(std::move(with)),
        left_(has) {}

  Nodes toClose() {
    Nodes closed;
    std::vector<Nodes> found = plugs(signs_, part_), others;
    if (found.size() > kMostTried) found.resize(kMostTried);
    const auto close = [&](const Nodes& plug) {
      closed.insert(closed.end(), plug.begin(), plug.end());
    };
    for (Nodes& plug : found) {
      if (touchesOther(plug)) continue;
      if (!runsInsideOut(plug))
        others.push_back(std::move(plug));
      else if (tryClosing(plug, [](const Sides&) { return true; }))
        close(plug);
    }
    std::optional<std::size_t> cuts = cutsOf(with_.side);
    if (!cuts) return closed;  // handles of its own
    for (const Nodes& plug : others)
      if (tryClosing(plug, [&](const Sides& with) {
            const std::optional<std::size_t> then = cutsOf(with);
            if (!then || *then + plug.size() >= *cuts) return false;
            cuts = then;
            return true;
          }))
        close(plug);
    return closed;
  }

 private:
  template <class Pays>
  bool tryClosing(const Nodes& plug, const Pays& pays) {
    if (left_ <= handles_) return false;
    throwIfCancelled();
    LatticeSigns with = with_;
    for (const std::size_t n : plug) with.side[n] = NodeSide::inside;
    const SolidTopology made = latticeTopology(with);
    if (made.components != 1 || made.cavities != 0 || made.handles >= left_ ||
        made.handles < handles_ || !pays(with.side))
      return false;
    left_ = made.handles;
    with_ = std::move(with);
    return true;
  }

  bool touchesOther(const Nodes& nodes) const {
    const auto other = [&](std::size_t n) {
      return all_[n] == NodeSide::inside && part_[n] != NodeSide::inside;
    };
    return std::any_of(nodes.begin(), nodes.end(), [&](std::size_t n) {
      for (int d = 0; d < kDirections; ++d)
        if (other(signs_.lattice.neighbour(n, d))) return true;
      return other(n);
    });
  }

  // Whether there is a region of winding number below 0 beside the plug.
  bool runsInsideOut(const Nodes& plug) const {
    std::set<std::size_t> seen(plug.begin(), plug.end());
    Nodes front(plug);
    for (int step = 0; step <= kNearby; ++step) {
      Nodes next;
      for (const std::size_t n : front) {
        if (winding_.wholeAt(signs_.lattice.position(n)) < 0) return true;
        for (int d = 0; d < kDirections; ++d) {
          const std::size_t beside = signs_.lattice.neighbour(n, d);
          if (isOutside(beside) && seen.insert(beside).second) next.push_back(beside);
        }
      }
      front = std::move(next);
    }
    return false;
  }

  // How many nodes the part has to lose; nothing where it cannot be grown.
  std::optional<std::size_t> cutsOf(const Sides& part) const {
    LatticeSigns grown = signs_;
    if (!growWithHandles(grown, part, handles_, order_)) return std::nullopt;
    return cutNodes(part, grown).size();
  }

  bool isOutside(std::size_t n) const {
    return part_[n] != NodeSide::inside && middle_[n] == NodeSide::inside;
  }

  const LatticeSigns& signs_;
  const Sides& part_;
  const Sides& all_;
  const int handles_;
  const std::vector<float>& order_;
  const WindingNumber winding_;
  const Sides middle_ = nodesWithNeighbours(signs_.lattice);
  LatticeSigns with_;  // the part with what was closed
  int left_;           // its handles
};

}  // namespace

Nodes tunnelsToClose(const Solid& solid, const LatticeSigns& signs, const Sides& part,
                     const Sides& all, int handles, const std::vector<float>& order) {
  LatticeSigns alone = signs;
  alone.side = part;
  const int has = latticeTopology(alone).handles;
  if (has <= handles) return {};
  return Tunnels(solid, signs, part, all, handles, order, std::move(alone), has).toClose();
}

}  // namespace innermap
