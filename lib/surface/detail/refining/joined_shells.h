// Several shells as one list of triangles.
#pragma once

#include <algorithm>
#include <vector>

#include "innermap/mesh/mesh.h"

namespace innermap {

struct JoinedShells {
  Points vertices;
  std::vector<Triangle> triangles;
  std::vector<std::size_t> first;  // triangle of each shell

  void add(const Points& points, const std::vector<Triangle>& list) {
    const int offset = static_cast<int>(vertices.size());
    vertices.insert(vertices.end(), points.begin(), points.end());
    first.push_back(triangles.size());
    for (const auto& [i, j, k] : list) triangles.push_back({i + offset, j + offset, k + offset});
  }

  struct Place {
    std::size_t shell;
    int triangle;  // of the shell
  };
  Place placeOf(int triangle) const {
    const std::size_t t = static_cast<std::size_t>(triangle);
    const std::size_t s = static_cast<std::size_t>(std::upper_bound(first.begin(), first.end(), t) -
                                                   first.begin() - 1);
    return {s, static_cast<int>(t - first[s])};
  }
};

}  // namespace innermap
