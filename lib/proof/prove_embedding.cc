#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "core/bvh.h"
#include "innermap/core/error.h"
#include "innermap/core/memory.h"
#include "innermap/core/run.h"
#include "innermap/proof/prove.h"
#include "mesh/connectivity.h"
#include "proof/detail/cell_limit.h"
#include "proof/detail/patch_tree.h"
#include "proof/detail/scale.h"
#include "proof/detail/set_group.h"

namespace innermap {
namespace {

using namespace proof;

// Pairs that one thread looks at in one go.
constexpr std::size_t kSiftBlock = 4096, kTestBlock = 128;
constexpr std::size_t kMostPlaces = 16;
constexpr std::uint64_t kBytesPerPair = 120, kBytesPerPatch = 700;
constexpr std::uint64_t kPairsPerPatch = 4;
// Pairs whose common box is larger than this many of them are split at once.
constexpr double kMostApart = 3;

// Patches of the surface that may have an image in common; first <= second.
using Pair = std::pair<int, int>;

double diagonal(const Box3& box) { return norm(box.extent()); }

Box3 joined(Box3 a, const Box3& b) {
  a.add(b);
  return a;
}

void setBox(const Box3& box, std::size_t lane, LaneSets& out) {
  constexpr int kSigns[4][3] = {{1, 1, 1}, {1, 1, -1}, {1, -1, 1}, {-1, 1, 1}};
  const Vec3 center = box.center();
  const Vec3 half = 0.5 * box.extent();
  const double margin = 4e-15 * (largestCoordinate(center) + largestCoordinate(half)) +
                        1e-3 * largestCoordinate(half);  // flat boxes are given some depth
  double square = 0;
  for (int a = 0; a < 3; ++a) {
    out.center[a][lane] = center[a];
    const double reach = half[a] + margin;
    square += reach * reach;
    for (int i = 0; i < 4; ++i) out.vertex[i][a][lane] = kSigns[i][a] * reach;
  }
  out.slack[lane] = 0;
  out.radius[lane] = std::sqrt(square) * (1 + 1e-14);
}

// Which of up to eight pairs lie in a box on which the map is one-to-one.
std::uint8_t oneToOne(const StepTrees& steps, const PatchTree& tree, const Pair* pairs,
                      std::size_t count, SetGroup& group) {
  LaneSets sets;
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    const auto [a, b] = pairs[std::min(lane, count - 1)];
    setBox(joined(tree[a].at, tree[b].at), lane, sets);
  }
  group.compute(steps, sets, static_cast<std::uint8_t>((1u << count) - 1), true);
  return group.proven();
}

struct Sifted {
  std::vector<Pair> near;  // to be looked for in one box
  std::vector<Pair> left;  // to be split
};

// Pairs whose images are not apart.
Sifted sift(const PatchTree& tree, const Pair* begin, const Pair* end) {
  Sifted out;
  for (const Pair* pair = begin; pair != end; ++pair) {
    const PatchTree::Node &a = tree[pair->first], &b = tree[pair->second];
    if (pair->first != pair->second && apart(a.image, b.image)) continue;
    const double together = diagonal(joined(a.at, b.at));
    // A box about both holds one about each.
    const bool hopeless = pair->first != pair->second && (a.folds || b.folds);
    const bool near =
        !hopeless && together <= kMostApart * std::max(diagonal(a.at), diagonal(b.at));
    (near ? out.near : out.left).push_back(*pair);
  }
  return out;
}

// By blocks, in order.
template <class Result, class Body>
std::vector<Result> inBlocks(std::size_t count, std::size_t size, const Body& body) {
  std::vector<Result> out((count + size - 1) / size);
  parallelBlocks(count, size,
                 [&](std::size_t begin, std::size_t end) { out[begin / size] = body(begin, end); });
  return out;
}

// Eight are looked at together, so that they should be alike and neighbours: by size, then place.
void sortPairs(const PatchTree& tree, std::vector<Pair>& pairs) {
  struct Keyed {
    int size;
    std::uint32_t place;
    Pair pair;
    bool operator<(const Keyed& other) const {
      return std::tie(size, place, pair) < std::tie(other.size, other.place, other.pair);
    }
  };
  std::vector<Keyed> keyed;
  for (const Pair& pair : pairs) {
    const Box3 box = joined(tree[pair.first].at, tree[pair.second].at);
    keyed.push_back({std::ilogb(diagonal(box)), curveKey(box.center(), tree[0].at), pair});
  }
  std::sort(keyed.begin(), keyed.end());
  for (std::size_t i = 0; i < pairs.size(); ++i) pairs[i] = keyed[i].pair;
}

// Pairs that are neither apart nor in one box.
std::vector<Pair> undecidedPairs(const StepTrees& steps, const PatchTree& tree,
                                 const std::vector<Pair>& pairs) {
  std::vector<Pair> near, left;
  for (const Sifted& s :
       inBlocks<Sifted>(pairs.size(), kSiftBlock, [&](std::size_t begin, std::size_t end) {
         return sift(tree, pairs.data() + begin, pairs.data() + end);
       })) {
    near.insert(near.end(), s.near.begin(), s.near.end());
    left.insert(left.end(), s.left.begin(), s.left.end());
  }
  sortPairs(tree, near);
  const auto test = [&](std::size_t begin, std::size_t end) {
    std::vector<Pair> out;
    SetGroup group;
    for (std::size_t i = begin; i < end; i += kLanes) {
      const std::size_t count = std::min(kLanes, end - i);
      const std::uint8_t proven = oneToOne(steps, tree, near.data() + i, count, group);
      for (std::size_t lane = 0; lane < count; ++lane)
        if (!(proven >> lane & 1)) out.push_back(near[i + lane]);
    }
    return out;
  };
  for (const std::vector<Pair>& some : inBlocks<std::vector<Pair>>(near.size(), kTestBlock, test))
    left.insert(left.end(), some.begin(), some.end());
  return left;
}

// Which of the two is split: the larger.
int largerOf(const PatchTree& tree, const Pair& pair) {
  return diagonal(tree[pair.second].at) > diagonal(tree[pair.first].at) ? pair.second : pair.first;
}

std::vector<Pair> splitPairs(const PatchTree& tree, const std::vector<Pair>& pairs) {
  std::vector<Pair> out;
  for (const Pair& pair : pairs) {
    const int larger = largerOf(tree, pair);
    const PatchTree::Node& node = tree[larger];
    const int other = larger == pair.first ? pair.second : pair.first;
    for (int i = node.first; i < node.first + node.count; ++i) {
      if (pair.first != pair.second) {
        out.emplace_back(std::min(i, other), std::max(i, other));
        continue;
      }
      for (int j = i; j < node.first + node.count; ++j) out.emplace_back(i, j);
    }
  }
  return out;
}

void cutLeaves(const StepTrees& steps, const std::vector<Pair>& pairs, PatchTree& tree) {
  std::vector<int> leaves;
  for (const Pair& pair : pairs)
    if (const int larger = largerOf(tree, pair); tree[larger].count == 0) leaves.push_back(larger);
  std::sort(leaves.begin(), leaves.end());
  leaves.erase(std::unique(leaves.begin(), leaves.end()), leaves.end());
  tree.cut(steps, leaves);
}

// Vertices that a file doubled along seams count as one.
bool isConnected(const Mesh& mesh) {
  std::vector<int> pieces = piecesByEdges(joinedTriangles(mesh.vertices, mesh.triangles));
  std::sort(pieces.begin(), pieces.end());
  pieces.erase(std::unique(pieces.begin(), pieces.end()), pieces.end());
  return pieces.size() == 1;
}

}  // namespace

EmbeddingProof proveEmbedding(const ExpandedMap& expanded, const Mesh& surface,
                              const ProofSettings& settings) {
  requireDescribed(settings);
  const ComposedMap& map = expanded.map();
  if (surface.triangles.empty())
    throw DataError(surface.name + ": has no triangles, so there is nothing to prove");
  validate(surface);
  const std::uint64_t patches =
      std::max<std::uint64_t>(cellLimit(map, settings), 2 * surface.triangles.size());
  const std::uint64_t limit = kPairsPerPatch * patches / map.steps().size();
  requireMemory("proving one-to-one",
                FieldTree::memory(map.sources()) + kBytesPerPatch * patches + kBytesPerPair * limit,
                "look at fewer cells a charge");
  const double scale = proofScale(boundingBox(surface));
  const auto expansions = expanded.expansions(scale);
  const StepTrees& steps = *expansions;
  PatchTree tree(steps, surface, scale, patches);
  EmbeddingProof out;
  out.connected = isConnected(surface);
  std::vector<Pair> pairs = {{0, 0}};
  while (!pairs.empty()) {
    reportProgress("proving one-to-one",
                   std::min(1.0, static_cast<double>(out.examined) / static_cast<double>(limit)));
    out.examined += pairs.size();
    pairs = undecidedPairs(steps, tree, pairs);
    if (out.examined + kLanes * pairs.size() > limit || tree.size() > 2 * patches) break;
    for (const Pair& pair : pairs)
      if (pair.first == pair.second) tree.setFolds(pair.first);
    cutLeaves(steps, pairs, tree);
    pairs = splitPairs(tree, pairs);
  }
  out.undecided = pairs.size();
  for (std::size_t i = 0; i < std::min(pairs.size(), kMostPlaces); ++i)
    out.places.push_back(tree[pairs[i].first].at.center() / scale);
  out.proven = pairs.empty();
  return out;
}

}  // namespace innermap
