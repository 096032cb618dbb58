#include <algorithm>

#include "innermap/mesh/check.h"

namespace innermap {

std::vector<Box3> capBoxes(const RepairedMesh& repaired) {
  return capBoxes(repaired, repaired.mesh.vertices);
}

std::vector<Box3> capBoxes(const RepairedMesh& repaired, const Points& positions) {
  const auto caps = std::find_if(repaired.parent.begin(), repaired.parent.end(),
                                 [](int parent) { return parent < 0; });
  return capBoxes(positions, repaired.mesh.triangles,
                  repaired.mesh.vertices.size() - repaired.capVertices.size(),
                  static_cast<std::size_t>(caps - repaired.parent.begin()));
}

std::vector<Box3> capBoxes(const Points& vertices, const std::vector<Triangle>& triangles,
                           std::size_t ownVertices, std::size_t ownTriangles) {
  std::vector<Box3> boxes;
  int fan = -1;  // the apex of the fan that the last triangle is of; -1: a cap of one triangle
  for (std::size_t t = ownTriangles; t < triangles.size(); ++t) {
    const int last = *std::max_element(triangles[t].begin(), triangles[t].end());
    const int apex = static_cast<std::size_t>(last) >= ownVertices ? last : -1;
    if (apex < 0 || apex != fan) boxes.emplace_back();
    fan = apex;
    for (const int v : triangles[t]) boxes.back().add(vertices[v]);
  }
  return boxes;
}

}  // namespace innermap
