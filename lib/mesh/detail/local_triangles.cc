#include "mesh/detail/local_triangles.h"

namespace innermap {

LocalTriangles::LocalTriangles(const Points& vertices, const std::vector<Triangle>& triangles) {
  Box3 box;
  index.reserve(triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const auto [i, j, k] = triangles[t];
    if (!isFinite(vertices[i]) || !isFinite(vertices[j]) || !isFinite(vertices[k])) continue;
    index.push_back(static_cast<int>(t));
    for (const int v : triangles[t]) box.add(vertices[v]);
  }
  frame = LocalFrame(box);
  corners.reserve(index.size());
  boxes.reserve(index.size());
  for (const int t : index) {
    const auto [i, j, k] = triangles[t];
    corners.push_back(
        {frame.toLocal(vertices[i]), frame.toLocal(vertices[j]), frame.toLocal(vertices[k])});
    Box3 b;
    b.add(corners.back().a);
    b.add(corners.back().b);
    b.add(corners.back().c);
    boxes.push_back(b);
  }
}

}  // namespace innermap
