#include "mesh/detail/topology.h"

#include <algorithm>
#include <numeric>

namespace innermap {
namespace {

std::vector<int> sortedUnique(std::vector<int> values) {
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
  return values;
}

// Walks along unused edges; where the path meets itself, the loop just closed is cut off. Balance
// at the vertices keeps the walk from being stuck anywhere but at its start.
class LoopTracer {
 public:
  LoopTracer(const std::vector<DirectedEdge>& edges, bool directed) : edges_(edges) {
    std::vector<int> ends;
    for (const DirectedEdge& e : edges) ends.insert(ends.end(), {e[0], e[1]});
    vertices_ = sortedUnique(std::move(ends));
    first_.assign(vertices_.size() + 1, 0);
    for (int pass = 0; pass < 2; ++pass) {
      for (std::size_t e = 0; e < edges.size(); ++e)
        for (int side = 0; side < (directed ? 1 : 2); ++side) {
          const int at = local(edges[e][side]);
          if (pass == 0)
            ++first_[at + 1];
          else
            ways_[next_[at]++] = {static_cast<int>(e), local(edges[e][1 - side])};
        }
      if (pass == 1) break;
      std::partial_sum(first_.begin(), first_.end(), first_.begin());
      ways_.resize(first_.back());
      next_.assign(first_.begin(), first_.end() - 1);
    }
    next_.assign(first_.begin(), first_.end() - 1);
    used_.assign(edges.size(), false);
    place_.assign(vertices_.size(), -1);
  }

  std::vector<std::vector<int>> run() {
    for (std::size_t e = 0; e < edges_.size(); ++e)
      if (!used_[e]) walk(local(edges_[e][0]));
    return std::move(loops_);
  }

 private:
  struct Way {
    int edge, to;
  };

  int local(int vertex) const {
    return static_cast<int>(std::lower_bound(vertices_.begin(), vertices_.end(), vertex) -
                            vertices_.begin());
  }

  void walk(int start) {
    std::vector<int> path{start};
    place_[start] = 0;
    for (;;) {
      const int at = path.back();
      while (next_[at] < first_[at + 1] && used_[ways_[next_[at]].edge]) ++next_[at];
      if (next_[at] == first_[at + 1]) break;
      const Way way = ways_[next_[at]++];
      used_[way.edge] = true;
      if (place_[way.to] < 0) {
        place_[way.to] = static_cast<int>(path.size());
        path.push_back(way.to);
      } else {
        cutOff(path, place_[way.to]);
      }
    }
    for (const int v : path) place_[v] = -1;
  }

  void cutOff(std::vector<int>& path, int from) {
    std::vector<int> loop;
    for (std::size_t k = from; k < path.size(); ++k) {
      loop.push_back(vertices_[path[k]]);
      if (static_cast<int>(k) > from) place_[path[k]] = -1;
    }
    path.resize(from + 1);
    loops_.push_back(std::move(loop));
  }

  const std::vector<DirectedEdge>& edges_;
  std::vector<int> vertices_, first_, next_, place_;
  std::vector<Way> ways_;
  std::vector<bool> used_;
  std::vector<std::vector<int>> loops_;
};

}  // namespace

std::vector<Triangle> mapped(const std::vector<Triangle>& triangles, const std::vector<int>& to) {
  std::vector<Triangle> result = triangles;
  for (Triangle& t : result)
    for (int& v : t) v = to[v];
  return result;
}

std::vector<std::vector<int>> traceLoops(const std::vector<DirectedEdge>& edges, bool directed) {
  return LoopTracer(edges, directed).run();
}

std::vector<DirectedEdge> cappingEdges(const std::vector<EdgeUse>& edges) {
  std::vector<DirectedEdge> result;
  forEachEdge(edges, [&](const EdgeUse* begin, const EdgeUse* end) {
    int net = 0;
    for (const EdgeUse* use = begin; use != end; ++use) net += use->forward ? 1 : -1;
    for (; net > 0; --net) result.push_back({begin->high, begin->low});
    for (; net < 0; ++net) result.push_back({begin->low, begin->high});
  });
  return result;
}

std::vector<std::pair<int, double>> loopCentroid(const Points& vertices,
                                                 const std::vector<int>& loop) {
  const std::size_t count = loop.size();
  std::vector<std::pair<int, double>> weights(count);
  double total = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const double length = norm(vertices[loop[(k + 1) % count]] - vertices[loop[k]]);
    weights[k].first = loop[k];
    weights[k].second += length;
    weights[(k + 1) % count].second += length;
    total += 2 * length;
  }
  for (auto& [vertex, weight] : weights)
    weight = total > 0 ? weight / total : 1.0 / static_cast<double>(count);
  return weights;
}

Vec3 weightedSum(const Points& vertices, const std::vector<std::pair<int, double>>& weights) {
  // About the first point: far from the origin, rounding of the sum of weights would show.
  const Vec3 origin = vertices[weights.front().first];
  Vec3 sum;
  for (const auto& [vertex, weight] : weights) sum += weight * (vertices[vertex] - origin);
  return origin + sum;
}

}  // namespace innermap
