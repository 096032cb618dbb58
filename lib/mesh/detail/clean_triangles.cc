#include "mesh/detail/clean_triangles.h"

#include <algorithm>
#include <tuple>

#include "mesh/detail/topology.h"

namespace innermap {
namespace {

struct Key {
  Triangle vertices;  // sorted
  bool even;          // whether the triangle runs through them in this order
  int triangle;

  auto order() const { return std::tie(vertices, even, triangle); }
};

bool runsUpward(const Triangle& t) {
  const int lowest = static_cast<int>(std::min_element(t.begin(), t.end()) - t.begin());
  return t[(lowest + 1) % 3] < t[(lowest + 2) % 3];
}

// Whether each side of triangle t has exactly one triangle that is not itself or its opposite.
bool fillsPlace(const Triangle& t, const std::vector<EdgeUse>& edges) {
  for (int c = 0; c < 3; ++c) {
    const int a = t[c], b = t[(c + 1) % 3];
    const std::array<int, 2> wanted{std::min(a, b), std::max(a, b)};
    auto use = std::lower_bound(edges.begin(), edges.end(), wanted,
                                [](const EdgeUse& e, const std::array<int, 2>& w) {
                                  return std::tie(e.low, e.high) < std::tie(w[0], w[1]);
                                });
    int uses = 0;
    for (; use != edges.end() && use->low == wanted[0] && use->high == wanted[1] && uses < 4; ++use)
      ++uses;
    if (uses != 3) return false;  // the pair and one other
  }
  return true;
}

}  // namespace

CleanTriangles cleanTriangles(const std::vector<Triangle>& triangles) {
  CleanTriangles result;
  std::vector<Key> keys;
  keys.reserve(triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    if (hasRepeatedVertex(triangles[t])) {
      ++result.repeatedVertex;
      continue;
    }
    Triangle sorted = triangles[t];
    std::sort(sorted.begin(), sorted.end());
    keys.push_back({sorted, runsUpward(triangles[t]), static_cast<int>(t)});
  }
  std::sort(keys.begin(), keys.end(),
            [](const Key& a, const Key& b) { return a.order() < b.order(); });

  std::vector<int> firsts;                // the first of each triangle and orientation
  std::vector<std::array<int, 2>> pairs;  // opposite firsts, the earlier one first
  for (std::size_t i = 0; i < keys.size(); ++i) {
    const bool sameVertices = i > 0 && keys[i].vertices == keys[i - 1].vertices;
    if (sameVertices && keys[i].even == keys[i - 1].even) {
      ++result.duplicates;
      continue;
    }
    if (sameVertices) {
      pairs.push_back(
          {std::min(firsts.back(), keys[i].triangle), std::max(firsts.back(), keys[i].triangle)});
      firsts.pop_back();
    } else {
      firsts.push_back(keys[i].triangle);
    }
  }
  result.kept = std::move(firsts);
  if (!pairs.empty()) {
    std::vector<Triangle> distinct;
    distinct.reserve(result.kept.size() + 2 * pairs.size());
    for (const int t : result.kept) distinct.push_back(triangles[t]);
    for (const auto& pair : pairs)
      for (const int t : pair) distinct.push_back(triangles[t]);
    const std::vector<EdgeUse> edges = sortedEdges(distinct);
    for (const auto& pair : pairs)
      if (fillsPlace(triangles[pair[0]], edges)) {
        result.kept.push_back(pair[0]);
        ++result.duplicates;
      } else {
        ++result.oppositePairs;
      }
  }
  std::sort(result.kept.begin(), result.kept.end());
  return result;
}

}  // namespace innermap
