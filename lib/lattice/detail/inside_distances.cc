#include "lattice/detail/inside_distances.h"

#include <algorithm>
#include <limits>
#include <queue>
#include <utility>

#include "innermap/core/run.h"

namespace innermap {
namespace {

constexpr float kFar = std::numeric_limits<float>::max();

}  // namespace

std::vector<float> distancesInside(const LatticeSigns& signs, std::vector<float> from) {
  using Entry = std::pair<float, std::size_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  for (std::size_t n = 0; n < from.size(); ++n)
    if (from[n] < kFar) queue.push({from[n], n});
  std::size_t polled = 0;
  while (!queue.empty()) {
    if (++polled % 65536 == 0) throwIfCancelled();
    const auto [distance, node] = queue.top();
    queue.pop();
    if (distance > from[node]) continue;
    for (int d = 0; d < kDirections; ++d) {
      const std::size_t next = signs.lattice.neighbour(node, d);
      if (signs.side[next] != NodeSide::inside) continue;
      const float there =
          distance + static_cast<float>(signs.lattice.length(d) / signs.lattice.spacing());
      if (there >= from[next]) continue;
      from[next] = there;
      queue.push({there, next});
    }
  }
  return from;
}

std::vector<float> depthsInside(const LatticeSigns& signs) {
  const auto spacing = static_cast<float>(signs.lattice.spacing());
  std::vector<float> near(signs.side.size(), kFar);
  for (std::size_t n = 0; n < near.size(); ++n)
    if (signs.side[n] == NodeSide::inside && signs.distance[n] > -1.9f * spacing)
      near[n] = std::max(0.0f, -signs.distance[n] / spacing);
  return distancesInside(signs, std::move(near));
}

}  // namespace innermap
