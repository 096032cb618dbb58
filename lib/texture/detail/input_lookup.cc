#include "texture/detail/input_lookup.h"

#include "innermap/core/error.h"

namespace innermap {

InputLookup::InputLookup(const Solid& solid, const Mesh& mesh, const std::vector<char>& bears,
                         const char* attribute)
    : solid_(solid), triangles_(mesh.triangles), bears_(bears) {
  if (bears.size() != mesh.triangles.size())
    throw DataError(mesh.name + ": the attribute is not one a triangle");
  for (const int parent : solid.repaired().parent)
    if (parent >= static_cast<int>(mesh.triangles.size()))
      throw DataError(mesh.name + ": is not the mesh that the solid was made of");
  const Mesh& surface = solid.surface();
  std::vector<Triangle> bearing;
  double area = 0;
  for (int t = 0; t < static_cast<int>(surface.triangles.size()); ++t) {
    if (!own({t, {1.0 / 3, 1.0 / 3, 1.0 / 3}})) continue;
    bearing.push_back(surface.triangles[static_cast<std::size_t>(t)]);
    bearing_.push_back(t);
    area += norm(areaVector(surface, t));
  }
  if (bearing.empty())
    throw DataError(mesh.name + ": no triangle of its outer surface has " + attribute);
  if (bearing.size() == surface.triangles.size()) {
    bearing_.clear();
    return;
  }
  bearingShare_ = solid.area() > 0 ? area / solid.area() : 1;
  tree_.emplace(surface.vertices, bearing);
}

std::optional<InputPoint> InputLookup::own(const SurfacePoint& onSurface) const {
  const SurfacePoint s = solid_.address(onSurface);
  const RepairedMesh& repaired = solid_.repaired();
  const int parent = repaired.parent[static_cast<std::size_t>(s.triangle)];
  if (parent < 0 || !bears_[static_cast<std::size_t>(parent)]) return {};
  // Repair may have turned the triangle: corners are told by their vertices.
  const Triangle& turned = repaired.mesh.triangles[static_cast<std::size_t>(s.triangle)];
  const Triangle& original = triangles_[static_cast<std::size_t>(parent)];
  InputPoint p{parent, {0, 0, 0}};
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t j = 0; j < 3; ++j)
      if (turned[k] == original[j]) p.weights[j] = s.barycentric[k];
  return p;
}

InputPoint InputLookup::at(const SurfacePoint& onSurface) const {
  if (const std::optional<InputPoint> p = own(onSurface)) return *p;
  SurfacePoint nearest = tree_->closest(positionOf(solid_.surface(), onSurface)).address;
  nearest.triangle = bearing_[static_cast<std::size_t>(nearest.triangle)];
  return *own(nearest);
}

}  // namespace innermap
