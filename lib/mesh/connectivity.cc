#include "mesh/connectivity.h"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <array>
#include <tuple>

#include "core/disjoint_sets.h"

namespace innermap {
namespace {

using Directed = std::array<int, 2>;

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

}  // namespace

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

std::vector<int> joinedVertices(const Points& vertices, const std::vector<Triangle>& triangles,
                                std::size_t* seamEdges) {
  if (seamEdges) *seamEdges = 0;
  std::vector<Directed> boundary;
  std::vector<int> ends;
  forEachEdge(sortedEdges(triangles), [&](const EdgeUse* begin, const EdgeUse* end) {
    if (end - begin != 1) return;
    boundary.push_back(begin->forward ? Directed{begin->low, begin->high}
                                      : Directed{begin->high, begin->low});
    ends.insert(ends.end(), {begin->low, begin->high});
  });
  const std::vector<int> number = positionNumbers(vertices, sortedUnique(std::move(ends)));
  const auto sorted = [&](const Directed& e) {
    const int a = number[e[0]], b = number[e[1]];
    return Directed{std::min(a, b), std::max(a, b)};
  };
  std::stable_sort(boundary.begin(), boundary.end(),
                   [&](const auto& a, const auto& b) { return sorted(a) < sorted(b); });
  DisjointSets sets(vertices.size());
  for (std::size_t i = 0; i < boundary.size();) {
    std::size_t j = i, ways[2] = {0, 0};
    for (; j < boundary.size() && sorted(boundary[j]) == sorted(boundary[i]); ++j)
      ++ways[number[boundary[j][0]] < number[boundary[j][1]] ? 0 : 1];
    const Directed positions = sorted(boundary[i]);
    if (ways[0] > 0 && ways[1] > 0 && positions[0] != positions[1]) {
      if (seamEdges) *seamEdges += std::min(ways[0], ways[1]);
      for (std::size_t k = i + 1; k < j; ++k)
        for (const int v : boundary[k])
          sets.unite(v, number[v] == number[boundary[i][0]] ? boundary[i][0] : boundary[i][1]);
    }
    i = j;
  }
  return sets.representatives();
}

std::vector<Triangle> joinedTriangles(const Points& vertices,
                                      const std::vector<Triangle>& triangles,
                                      std::size_t* seamEdges) {
  const std::vector<int> to = joinedVertices(vertices, triangles, seamEdges);
  std::vector<Triangle> out = triangles;
  for (Triangle& t : out)
    for (int& v : t) v = to[v];
  return out;
}

std::vector<int> piecesByEdges(const std::vector<Triangle>& triangles) {
  DisjointSets pieces(triangles.size());
  forEachEdge(sortedEdges(triangles), [&](const EdgeUse* begin, const EdgeUse* end) {
    if (end - begin == 2) pieces.unite(begin[0].triangle, begin[1].triangle);
  });
  std::vector<int> out = pieces.representatives();
  for (std::size_t t = 0; t < out.size(); ++t)
    if (hasRepeatedVertex(triangles[t])) out[t] = -1;
  return out;
}

}  // namespace innermap
