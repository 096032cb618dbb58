#include "innermap/mesh/mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "innermap/core/error.h"

namespace innermap {
namespace {

[[noreturn]] void invalid(const Mesh& mesh, const std::string& what) {
  throw DataError((mesh.name.empty() ? "mesh" : mesh.name) + ": " + what);
}

void validatePolygons(const Mesh& mesh) {
  if (mesh.polygonStart.empty()) {
    if (!mesh.polygonCorners.empty()) invalid(mesh, "has polygon corners without polygon starts");
    return;
  }
  if (mesh.polygonStart.front() != 0 ||
      static_cast<std::size_t>(mesh.polygonStart.back()) != mesh.polygonCorners.size())
    invalid(mesh, "polygon starts do not span the polygon corners");
  for (std::size_t p = 0; p + 1 < mesh.polygonStart.size(); ++p)
    if (mesh.polygonStart[p + 1] < mesh.polygonStart[p])
      invalid(mesh, fmt::format("polygon {} has a negative number of corners", p));
  for (const int v : mesh.polygonCorners)
    if (v < 0 || static_cast<std::size_t>(v) >= mesh.vertices.size())
      invalid(mesh, fmt::format("a polygon uses vertex {} of {} (counted from 0)", v,
                                mesh.vertices.size()));
}

void validateAttributes(const Mesh& mesh) {
  if (!mesh.colours.empty() && mesh.colours.size() != mesh.vertices.size())
    invalid(mesh, fmt::format("has {} colours for {} vertices", mesh.colours.size(),
                              mesh.vertices.size()));
  if (!mesh.uvTriangles.empty() && mesh.uvTriangles.size() != mesh.triangles.size())
    invalid(mesh, fmt::format("has texture coordinates for {} of {} triangles",
                              mesh.uvTriangles.size(), mesh.triangles.size()));
  for (const Triangle& t : mesh.uvTriangles)
    for (const int uv : t)
      if (uv < -1 || (uv >= 0 && static_cast<std::size_t>(uv) >= mesh.uvs.size()))
        invalid(mesh, fmt::format("a triangle uses texture coordinate {} of {} (counted from 0)",
                                  uv, mesh.uvs.size()));
}

double volumeAbout(const Vec3& centre, const Points& vertices,
                   const std::vector<Triangle>& triangles) {
  double volume = 0;
  for (const Triangle& t : triangles)
    volume += dot(vertices[t[0]] - centre, cross(vertices[t[1]] - centre, vertices[t[2]] - centre));
  return volume / 6;
}

}  // namespace

void validate(const Mesh& mesh) {
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (const int v : mesh.triangles[t]) {
      if (v < 0 || static_cast<std::size_t>(v) >= mesh.vertices.size())
        invalid(mesh, fmt::format("triangle {} uses vertex {} of {} (counted from 0)", t, v,
                                  mesh.vertices.size()));
      if (!isFinite(mesh.vertices[v]))
        invalid(mesh, fmt::format("vertex {} is not finite; remove or correct it", v));
    }
  validatePolygons(mesh);
  validateAttributes(mesh);
}

Vec3 positionOf(const Mesh& mesh, const SurfacePoint& point) {
  const Triangle& t = mesh.triangles[point.triangle];
  return point.barycentric[0] * mesh.vertices[t[0]] + point.barycentric[1] * mesh.vertices[t[1]] +
         point.barycentric[2] * mesh.vertices[t[2]];
}

Points interpolate(const Points& positions, const std::vector<Triangle>& triangles,
                   const std::vector<SurfacePoint>& points) {
  Points result;
  result.reserve(points.size());
  for (const SurfacePoint& point : points) {
    const Triangle& t = triangles[point.triangle];
    result.push_back(point.barycentric[0] * positions[t[0]] +
                     point.barycentric[1] * positions[t[1]] +
                     point.barycentric[2] * positions[t[2]]);
  }
  return result;
}

Vec3 areaVector(const Mesh& mesh, int triangle) {
  const Triangle& t = mesh.triangles[triangle];
  const Vec3& a = mesh.vertices[t[0]];
  return 0.5 * cross(mesh.vertices[t[1]] - a, mesh.vertices[t[2]] - a);
}

void requireNearOrigin(const Mesh& mesh) {
  const Box3 box = boundingBox(mesh);
  const double diagonal = box.diagonal();
  if (!(diagonal > 0)) return;
  double farthest = 0;
  for (int a = 0; a < 3; ++a)
    farthest = std::max({farthest, std::abs(box.lower[a]), std::abs(box.upper[a])});
  if (farthest > kMostFromOrigin * diagonal)
    invalid(mesh, fmt::format(
                      "lies {:.2g} of its diagonals from the origin, {:g} at most can be computed "
                      "with; move it nearer to the origin",
                      farthest / diagonal, kMostFromOrigin));
}

Box3 boundingBox(const Mesh& mesh) {
  Box3 box;
  for (const Triangle& t : mesh.triangles)
    for (const int v : t) box.add(mesh.vertices[v]);
  return box;
}

double surfaceArea(const Mesh& mesh) { return surfaceArea(mesh.vertices, mesh.triangles); }

double surfaceArea(const Points& vertices, const std::vector<Triangle>& triangles) {
  double area = 0;
  for (const Triangle& t : triangles) {
    const Vec3& a = vertices[t[0]];
    area += 0.5 * norm(cross(vertices[t[1]] - a, vertices[t[2]] - a));
  }
  return area;
}

double signedVolume(const Mesh& mesh) {
  return volumeAbout(boundingBox(mesh).center(), mesh.vertices, mesh.triangles);
}

double signedVolume(const Points& vertices, const std::vector<Triangle>& triangles) {
  return volumeAbout(boundingBox(vertices).center(), vertices, triangles);
}

}  // namespace innermap
