#include "mesh/self_intersection.h"

#include <algorithm>

#include "core/bvh.h"
#include "innermap/mesh/check.h"
#include "mesh/detail/intersect_triangles.h"
#include "mesh/detail/topology.h"

namespace innermap {

void forEachSelfIntersection(const Points& vertices, const std::vector<Triangle>& triangles,
                             const std::function<void(const Crossing&)>& visit) {
  forEachSelfIntersection(TriangleTree(vertices, triangles), vertices, triangles, visit);
}

void forEachSelfIntersection(const TriangleTree& tree, const Points& vertices,
                             const std::vector<Triangle>& triangles,
                             const std::function<void(const Crossing&)>& visit) {
  // Scaled by a power of two, which changes no bit of a mantissa: products of far too large or too
  // small coordinates stay in range.
  Box3 box;
  for (const Triangle& t : triangles)
    for (const int v : t) box.add(vertices[v]);
  const LocalFrame frame(box);
  Points scaled(vertices.size());
  for (std::size_t v = 0; v < vertices.size(); ++v) scaled[v] = frame.scale * vertices[v];

  const auto corners = [&](int t) {
    const Triangle& triangle = triangles[t];
    return TriangleCorners{scaled[triangle[0]], scaled[triangle[1]], scaled[triangle[2]]};
  };
  std::vector<std::vector<Crossing>> found(TriangleTree::kParts);
  const auto look = [&](std::size_t part, int i, int j) {
    if (hasRepeatedVertex(triangles[i]) || hasRepeatedVertex(triangles[j])) return;
    Vec3 place;
    if (passThrough(corners(i), corners(j), place))
      found[part].push_back({i, j, frame.inverse * place});
  };
  tree.overlappingPairs(look, [&] {
    for (std::vector<Crossing>& part : found) {
      for (const Crossing& crossing : part) visit(crossing);
      part.clear();
    }
  });
}

std::vector<Crossing> selfIntersections(const Points& vertices,
                                        const std::vector<Triangle>& triangles) {
  std::vector<Crossing> crossings;
  forEachSelfIntersection(vertices, triangles,
                          [&](const Crossing& crossing) { crossings.push_back(crossing); });
  std::sort(crossings.begin(), crossings.end(), [](const Crossing& a, const Crossing& b) {
    return a.first != b.first ? a.first < b.first : a.second < b.second;
  });
  return crossings;
}

}  // namespace innermap
