#include "fit/detail/exposed_pair.h"

namespace innermap {

ExposedPair exposedPair(const BoundaryPair& boundary) {
  const Mesh& mesh = boundary.solid().surface();
  ExposedPair out;
  std::vector<SurfacePoint> corners;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto first = static_cast<int>(out.surface.vertices.size());
    out.surface.triangles.push_back({first, first + 1, first + 2});
    for (int c = 0; c < 3; ++c) {
      out.surface.vertices.push_back(
          mesh.vertices[static_cast<std::size_t>(mesh.triangles[t][static_cast<std::size_t>(c)])]);
      SurfacePoint corner{static_cast<int>(t), {0, 0, 0}};
      corner.barycentric[static_cast<std::size_t>(c)] = 1;
      corners.push_back(corner);
    }
  }
  const Matrix to = boundary.targetsOf(corners);
  for (std::size_t i = 0; i < corners.size(); ++i)
    out.targets.push_back({to(i, 0), to(i, 1), to(i, 2)});
  return out;
}

}  // namespace innermap
