#include <algorithm>
#include <array>

#include "innermap/core/run.h"
#include "innermap/mesh/check.h"
#include "mesh/detail/intersect_triangles.h"
#include "mesh/detail/local_triangles.h"
#include "mesh/detail/topology.h"
#include "mesh/triangle_tree.h"

namespace innermap {
namespace {

constexpr std::size_t kBatch = 1 << 17, kBlock = 1 << 12;

}  // namespace

void forEachSelfIntersection(const Points& vertices, const std::vector<Triangle>& triangles,
                             const std::function<void(const Crossing&)>& visit) {
  // Scaled by a power of two, which changes no bit of a mantissa: products of far too large or too
  // small coordinates stay in range.
  Box3 box;
  for (const Triangle& t : triangles)
    for (const int v : t) box.add(vertices[v]);
  const LocalFrame frame(box);
  Points scaled(vertices.size());
  for (std::size_t v = 0; v < vertices.size(); ++v) scaled[v] = frame.scale * vertices[v];

  std::vector<std::array<int, 2>> pairs;
  std::vector<std::vector<Crossing>> found(kBatch / kBlock + 1);
  const auto corners = [&](int t) {
    const Triangle& triangle = triangles[t];
    return TriangleCorners{scaled[triangle[0]], scaled[triangle[1]], scaled[triangle[2]]};
  };
  const auto flush = [&] {
    parallelBlocks(pairs.size(), kBlock, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) {
        Vec3 place;
        if (passThrough(corners(pairs[k][0]), corners(pairs[k][1]), place))
          found[begin / kBlock].push_back({pairs[k][0], pairs[k][1], frame.inverse * place});
      }
    });
    for (std::vector<Crossing>& block : found) {
      for (const Crossing& crossing : block) visit(crossing);
      block.clear();
    }
    pairs.clear();
  };
  TriangleTree(vertices, triangles).overlappingPairs([&](int i, int j) {
    if (hasRepeatedVertex(triangles[i]) || hasRepeatedVertex(triangles[j])) return;
    pairs.push_back({i, j});
    if (pairs.size() == kBatch) flush();
  });
  flush();
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
