#include "surface/detail/topology/edge_distance.h"

#include <functional>
#include <limits>
#include <queue>
#include <utility>

namespace innermap {

std::vector<double> EdgeDistance::operator()(const std::vector<int>& sources,
                                             std::vector<int>* reachedBy) const {
  std::vector<double> distance(surface_.vertices.size(), std::numeric_limits<double>::infinity());
  if (reachedBy) reachedBy->assign(distance.size(), -1);
  using Entry = std::pair<double, int>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  for (const int v : sources) {
    distance[v] = 0;
    queue.push({0, v});
  }
  while (!queue.empty()) {
    const auto [d, v] = queue.top();
    queue.pop();
    if (d > distance[v]) continue;
    int h = outgoing_[v];
    do {
      const int w = edges_.head(h);
      const double through = d + norm(surface_.vertices[w] - surface_.vertices[v]);
      if (through < distance[w]) {
        distance[w] = through;
        if (reachedBy) (*reachedBy)[w] = h;
        queue.push({through, w});
      }
      h = edges_.counterclockwise(h);
    } while (h != outgoing_[v]);
  }
  return distance;
}

}  // namespace innermap
