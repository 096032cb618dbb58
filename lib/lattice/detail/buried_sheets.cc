#include "lattice/detail/buried_sheets.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/disjoint_sets.h"
#include "core/random.h"
#include "innermap/core/run.h"
#include "lattice/detail/inside_distances.h"

namespace innermap {
namespace {

constexpr char kStage[] = "looking for buried sheets";
// Lengths in spacings.
constexpr float kUnreached = std::numeric_limits<float>::max();
constexpr double kApart = 0.35;       // of samples of the sheets
constexpr double kMostSamples = 4e6;  // sparser ones where the sheets have so much area
constexpr double kLinked = 0.9;       // samples of one patch
constexpr double kBuried = 1.3;       // of the nearest node, whose distances end at 2
constexpr float kShallow = 3;         // the deepest node along a patch that does not count
constexpr float kBeside = 1;          // nodes nearer to a sheet stand on it
constexpr float kOnExposed = -0.05f;  // order of nodes on sheets: exposed ones, buried ones
constexpr float kOnLargest = -0.1f, kOnSmallest = -1;

struct Sample {
  Vec3 at;
  int triangle;
  float order;
};

std::vector<Sample> samplesOf(const Mesh& mesh, double apart) {
  double all = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    all += norm(areaVector(mesh, static_cast<int>(t)));
  apart = std::max(apart, std::sqrt(all / kMostSamples));
  const CounterRandom random(1, 71);
  std::vector<Sample> samples;
  std::uint64_t drawn = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (t % 65536 == 0) throwIfCancelled();
    const auto& [a, b, c] = mesh.triangles[t];
    const Vec3 &p = mesh.vertices[a], &q = mesh.vertices[b], &r = mesh.vertices[c];
    const double area = 0.5 * norm(cross(q - p, r - p));
    const auto count = static_cast<std::size_t>(std::max(1.0, std::ceil(area / (apart * apart))));
    for (std::size_t i = 0; i < count; ++i) {
      const double s = std::sqrt(random.uniform(drawn)), u = random.uniform(drawn + 1);
      drawn += 2;
      samples.push_back(
          {(1 - s) * p + s * (1 - u) * q + s * u * r, static_cast<int>(t), kOnExposed});
    }
  }
  return samples;
}

bool touch(const Triangle& a, const Triangle& b) {
  return std::any_of(a.begin(), a.end(),
                     [&](int v) { return std::find(b.begin(), b.end(), v) != b.end(); });
}

// Sets of samples that hang together along the mesh: of each its lowest member.
std::vector<int> patchesOf(const std::vector<Sample>& samples, const Mesh& mesh, double linked) {
  using Cell = std::array<int, 3>;
  std::vector<std::pair<Cell, int>> cells;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    Cell cell{};
    for (int a = 0; a < 3; ++a)
      cell[a] = static_cast<int>(std::floor((samples[i].at[a] - samples[0].at[a]) / linked));
    cells.push_back({cell, static_cast<int>(i)});
  }
  std::sort(cells.begin(), cells.end());
  DisjointSets sets(samples.size());
  for (const auto& [cell, i] : cells)
    for (int dx = -1; dx <= 1; ++dx)
      for (int dy = -1; dy <= 1; ++dy) {
        const Cell low{cell[0] + dx, cell[1] + dy, cell[2] - 1};
        const int top = cell[2] + 1;
        for (auto at = std::lower_bound(cells.begin(), cells.end(), std::pair<Cell, int>{low, 0});
             at != cells.end() && at->first[0] == low[0] && at->first[1] == low[1] &&
             at->first[2] <= top;
             ++at) {
          const int j = at->second;
          if (j >= i || squaredNorm(samples[i].at - samples[j].at) > linked * linked) continue;
          const int s = samples[i].triangle, t = samples[j].triangle;
          if (s == t || touch(mesh.triangles[s], mesh.triangles[t])) sets.unite(i, j);
        }
      }
  return sets.representatives();
}

// The samples of exposed sheets and those of patches that are buried deep, with their orders.
std::vector<Sample> sheets(const Solid& solid, const LatticeSigns& signs,
                           const std::vector<float>& depth) {
  const Mesh& mesh = solid.repaired().mesh;
  const double spacing = signs.lattice.spacing();
  std::vector<Sample> exposed, buried;
  for (const Sample& s : samplesOf(mesh, kApart * spacing)) {
    const std::size_t node = signs.lattice.nearest(s.at);
    const bool inside = signs.side[node] == NodeSide::inside;
    (inside && static_cast<double>(depth[node]) > kBuried ? buried : exposed).push_back(s);
  }
  if (buried.empty()) return exposed;
  const std::vector<int> patch = patchesOf(buried, mesh, kLinked * spacing);
  std::vector<std::size_t> size(buried.size(), 0);
  std::vector<float> deepest(buried.size(), 0);
  for (std::size_t i = 0; i < buried.size(); ++i) {
    ++size[patch[i]];
    float& deep = deepest[patch[i]];
    deep = std::max(deep, depth[signs.lattice.nearest(buried[i].at)]);
  }
  std::size_t largest = 1;
  for (std::size_t i = 0; i < buried.size(); ++i)
    if (deepest[i] > kShallow) largest = std::max(largest, size[i]);
  for (std::size_t i = 0; i < buried.size(); ++i) {
    if (!(deepest[patch[i]] > kShallow)) continue;
    const float share = static_cast<float>(size[patch[i]]) / static_cast<float>(largest);
    buried[i].order = kOnSmallest + (kOnLargest - kOnSmallest) * share;
    exposed.push_back(buried[i]);
  }
  return exposed;
}

}  // namespace

std::vector<float> growingOrder(const Solid& solid, const LatticeSigns& signs,
                                const std::vector<float>& depth) {
  reportProgress(kStage, 0);
  const BccLattice& lattice = signs.lattice;
  std::vector<float> nearest(signs.side.size(), kUnreached), order(signs.side.size(), kUnreached);
  for (const Sample& s : sheets(solid, signs, depth)) {
    const std::size_t at = lattice.nearest(s.at);
    for (int d = -1; d < kDirections; ++d) {
      const std::size_t node = d < 0 ? at : lattice.neighbour(at, d);
      const auto distance =
          static_cast<float>(norm(lattice.position(node) - s.at) / lattice.spacing());
      if (signs.side[node] != NodeSide::inside || distance >= std::min(nearest[node], kBeside))
        continue;
      nearest[node] = distance;
      order[node] = s.order;
    }
  }
  reportProgress(kStage, 0.5);
  const std::vector<float> away = distancesInside(signs, std::move(nearest));
  for (std::size_t n = 0; n < order.size(); ++n)
    if (order[n] == kUnreached) order[n] = away[n];
  reportProgress(kStage, 1);
  return order;
}

}  // namespace innermap
