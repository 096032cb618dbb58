#include "transfer/detail/leaf_index.h"

#include <array>
#include <optional>

namespace innermap {
namespace {

// Leaf coordinates of 21 bits each: OpenVDB's indices beyond 2^23 do not occur on one lattice here.
std::uint64_t keyOf(const openvdb::Coord& ijk) {
  constexpr std::uint64_t kMask = (1u << 21) - 1;
  const auto part = [](int i) { return static_cast<std::uint64_t>(i >> 3) & kMask; };
  return part(ijk.x()) << 42 | part(ijk.y()) << 21 | part(ijk.z());
}

// The 26 neighbours, nearest first.
std::array<openvdb::Coord, 26> neighbours() {
  std::array<openvdb::Coord, 26> out;
  std::size_t n = 0;
  for (int steps = 1; steps <= 3; ++steps)
    for (int x = -1; x <= 1; ++x)
      for (int y = -1; y <= 1; ++y)
        for (int z = -1; z <= 1; ++z)
          if (x * x + y * y + z * z == steps) out[n++] = {x, y, z};
  return out;
}

std::optional<LeafPlace> neighbourWith(const LeafIndex& region,
                                       const std::vector<std::bitset<512>>& has, LeafPlace at) {
  static const std::array<openvdb::Coord, 26> kNeighbours = neighbours();
  const openvdb::Coord ijk = region[at.leaf].offsetToGlobalCoord(at.offset);
  for (const openvdb::Coord& step : kNeighbours) {
    const openvdb::Coord next = ijk + step;
    const auto offset = static_cast<std::uint16_t>(LeafIndex::Leaf::coordToOffset(next));
    const std::uint32_t leaf = region.find(next);
    if (leaf != LeafIndex::kNone && has[leaf][offset]) return LeafPlace{leaf, offset};
  }
  return std::nullopt;
}

}  // namespace

LeafIndex::LeafIndex(const openvdb::MaskTree& region)
    : LeafIndex([&] {
        std::vector<const Leaf*> leaves;
        for (auto leaf = region.cbeginLeaf(); leaf; ++leaf) leaves.push_back(leaf.getLeaf());
        return leaves;
      }()) {}

LeafIndex::LeafIndex(std::vector<const Leaf*> leaves) : leaves_(std::move(leaves)) {
  for (std::size_t l = 0; l < leaves_.size(); ++l)
    byOrigin_.emplace(keyOf(leaves_[l]->origin()), static_cast<std::uint32_t>(l));
}

std::uint32_t LeafIndex::find(const openvdb::Coord& ijk) const {
  const auto found = byOrigin_.find(keyOf(ijk));
  return found == byOrigin_.end() ? kNone : found->second;
}

void spreadToNeighbours(const LeafIndex& region, std::vector<std::bitset<512>>& has,
                        const std::function<void(LeafPlace, LeafPlace)>& copy) {
  std::vector<LeafPlace> waiting;
  for (std::uint32_t l = 0; l < region.size(); ++l)
    for (auto voxel = region[l].cbeginValueOn(); voxel; ++voxel)
      if (!has[l][voxel.pos()]) waiting.push_back({l, static_cast<std::uint16_t>(voxel.pos())});
  for (bool moved = true; moved && !waiting.empty();) {
    std::vector<std::pair<LeafPlace, LeafPlace>> layer;
    std::vector<LeafPlace> rest;
    for (const LeafPlace& to : waiting) {
      const std::optional<LeafPlace> from = neighbourWith(region, has, to);
      if (from)
        layer.emplace_back(*from, to);
      else
        rest.push_back(to);
    }
    for (const auto& [from, to] : layer) {
      copy(from, to);
      has[to.leaf].set(to.offset);
    }
    moved = !layer.empty();
    waiting = std::move(rest);
  }
}

}  // namespace innermap
