#include "innermap/mesh/detail/topology.h"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <numeric>
#include <tuple>

namespace innermap {
namespace {

// Numbers in order of position, equal for equal positions.
std::vector<int> positionNumbers(const Points& vertices, const std::vector<int>& chosen) {
  std::vector<int> order = chosen;
  const auto key = [&](int v) { return std::tuple(vertices[v].x, vertices[v].y, vertices[v].z); };
  tbb::parallel_sort(order.begin(), order.end(),
                     [&](int a, int b) { return key(a) != key(b) ? key(a) < key(b) : a < b; });
  std::vector<int> numbers(vertices.size(), -1);
  int number = 0;
  for (std::size_t i = 0; i < order.size(); ++i) {
    if (i > 0 && key(order[i]) != key(order[i - 1])) ++number;
    numbers[order[i]] = number;
  }
  return numbers;
}

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

DisjointSets::DisjointSets(std::size_t count) : parent_(count) {
  std::iota(parent_.begin(), parent_.end(), 0);
}

int DisjointSets::find(int i) {
  while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
  return i;
}

void DisjointSets::unite(int i, int j) {
  i = find(i);
  j = find(j);
  parent_[std::max(i, j)] = std::min(i, j);
}

std::vector<EdgeUse> sortedEdges(const std::vector<Triangle>& triangles) {
  std::vector<EdgeUse> edges;
  edges.reserve(3 * triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    if (hasRepeatedVertex(triangles[t])) continue;
    for (int c = 0; c < 3; ++c) {
      const int a = triangles[t][c], b = triangles[t][(c + 1) % 3];
      edges.push_back({std::min(a, b), std::max(a, b), static_cast<int>(t),
                       static_cast<std::int8_t>(c), a < b});
    }
  }
  // No two uses compare equal, so the order is the same for any number of threads.
  tbb::parallel_sort(edges.begin(), edges.end(), [](const EdgeUse& a, const EdgeUse& b) {
    if (a.low != b.low) return a.low < b.low;
    return a.high != b.high ? a.high < b.high : a.triangle < b.triangle;
  });
  return edges;
}

void forEachEdge(const std::vector<EdgeUse>& edges,
                 const std::function<void(const EdgeUse*, const EdgeUse*)>& visit) {
  const EdgeUse* const end = edges.data() + edges.size();
  for (const EdgeUse* begin = edges.data(); begin != end;) {
    const EdgeUse* stop = begin + 1;
    while (stop != end && stop->low == begin->low && stop->high == begin->high) ++stop;
    visit(begin, stop);
    begin = stop;
  }
}

std::vector<int> joinSeams(const Points& vertices, const std::vector<Triangle>& triangles,
                           std::size_t* seamEdges) {
  if (seamEdges) *seamEdges = 0;
  std::vector<DirectedEdge> boundary;
  std::vector<int> ends;
  forEachEdge(sortedEdges(triangles), [&](const EdgeUse* begin, const EdgeUse* end) {
    if (end - begin != 1) return;
    boundary.push_back(begin->forward ? DirectedEdge{begin->low, begin->high}
                                      : DirectedEdge{begin->high, begin->low});
    ends.insert(ends.end(), {begin->low, begin->high});
  });
  const std::vector<int> number = positionNumbers(vertices, sortedUnique(std::move(ends)));
  const auto sorted = [&](const DirectedEdge& e) {
    const int a = number[e[0]], b = number[e[1]];
    return DirectedEdge{std::min(a, b), std::max(a, b)};
  };
  std::stable_sort(boundary.begin(), boundary.end(),
                   [&](const auto& a, const auto& b) { return sorted(a) < sorted(b); });
  DisjointSets sets(vertices.size());
  for (std::size_t i = 0; i < boundary.size();) {
    std::size_t j = i, ways[2] = {0, 0};
    for (; j < boundary.size() && sorted(boundary[j]) == sorted(boundary[i]); ++j)
      ++ways[number[boundary[j][0]] < number[boundary[j][1]] ? 0 : 1];
    const DirectedEdge positions = sorted(boundary[i]);
    if (ways[0] > 0 && ways[1] > 0 && positions[0] != positions[1]) {
      if (seamEdges) *seamEdges += std::min(ways[0], ways[1]);
      for (std::size_t k = i + 1; k < j; ++k)
        for (const int v : boundary[k])
          sets.unite(v, number[v] == number[boundary[i][0]] ? boundary[i][0] : boundary[i][1]);
    }
    i = j;
  }
  std::vector<int> representative(vertices.size());
  for (std::size_t v = 0; v < vertices.size(); ++v)
    representative[v] = sets.find(static_cast<int>(v));
  return representative;
}

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
