#include "mesh/detail/polygon_mesh.h"

#include <fmt/format.h>

#include <algorithm>

#include "innermap/core/error.h"
#include "innermap/core/run.h"
#include "mesh/triangulate.h"

namespace innermap {
namespace {

std::string listed(const int* corners, int count) {
  std::string text;
  for (int k = 0; k < std::min(count, 6); ++k)
    text += fmt::format("{}{}", k ? " " : "", corners[k]);
  return "(" + text + (count > 6 ? " ...)" : ")");
}

[[noreturn]] void differs(const std::string& path, const Mesh& reference, const std::string& what) {
  throw DataError(fmt::format(
      "{}: {} (reference {}); the two meshes must have the same connectivity, others need a "
      "correspondence first (innermap correspond)",
      path, what, reference.name.empty() ? "mesh" : reference.name));
}

// Face f of a mesh, be its faces polygons or triangles.
struct Faces {
  const std::vector<int>* start = nullptr;
  const std::vector<int>* corners = nullptr;
  const std::vector<Triangle>* triangles = nullptr;

  std::size_t size() const { return start ? start->size() - 1 : triangles->size(); }
  int count(std::size_t f) const { return start ? (*start)[f + 1] - (*start)[f] : 3; }
  const int* at(std::size_t f) const {
    return start ? corners->data() + (*start)[f] : (*triangles)[f].data();
  }
};

Faces facesOf(const Mesh& mesh, bool polygons) {
  Faces faces;
  if (polygons && !mesh.polygonStart.empty()) {
    faces.start = &mesh.polygonStart;
    faces.corners = &mesh.polygonCorners;
  } else {
    faces.triangles = &mesh.triangles;
  }
  return faces;
}

void requireEqual(const Mesh& mesh, const Mesh& reference, bool polygons) {
  if (mesh.vertices.size() != reference.vertices.size())
    differs(mesh.name, reference,
            fmt::format("has {} vertices, the reference {}", mesh.vertices.size(),
                        reference.vertices.size()));
  const Faces a = facesOf(mesh, polygons), b = facesOf(reference, polygons);
  const char* kind = polygons ? "polygon" : "triangle";
  for (std::size_t f = 0; f < std::min(a.size(), b.size()); ++f)
    if (a.count(f) != b.count(f) || !std::equal(a.at(f), a.at(f) + a.count(f), b.at(f)))
      differs(mesh.name, reference,
              fmt::format("{} {} has vertices {}, in the reference {} (counted from 0)", kind, f,
                          listed(a.at(f), a.count(f)), listed(b.at(f), b.count(f))));
  if (a.size() != b.size())
    differs(mesh.name, reference,
            fmt::format("has {} {}s, the reference {}", a.size(), kind, b.size()));
}

// The file's texture coordinates for the reference's triangles, which cut the same polygons.
std::vector<Triangle> recutUvs(const PolygonMesh& polygons,
                               const std::vector<Triangle>& triangles) {
  std::vector<Triangle> result(triangles.size(), Triangle{-1, -1, -1});
  std::size_t t = 0;
  for (std::size_t p = 0; p < polygons.polygons(); ++p) {
    const int begin = polygons.start[p], end = polygons.start[p + 1];
    for (int k = begin + 2; k < end && t < triangles.size(); ++k, ++t)
      for (int c = 0; c < 3; ++c) {
        const auto first = polygons.corners.begin() + begin, last = polygons.corners.begin() + end;
        const auto found = std::find(first, last, triangles[t][c]);
        if (found != last) result[t][c] = polygons.uvCorners[found - polygons.corners.begin()];
      }
  }
  return result;
}

}  // namespace

std::array<float, 3> clampedColour(double red, double green, double blue) {
  const auto clamped = [](double c) { return c > 0 ? static_cast<float>(std::min(c, 1.0)) : 0.0f; };
  return {clamped(red), clamped(green), clamped(blue)};
}

Mesh toMesh(PolygonMesh&& polygons, const std::string& path) {
  if (polygons.vertices.empty())
    throw FileError(path, "has no vertices; give a triangle or polygon mesh");
  if (polygons.polygons() == 0)
    throw FileError(path, "has no faces; give a triangle or polygon mesh, not points or curves");
  Mesh mesh;
  mesh.name = path;
  mesh.vertices = std::move(polygons.vertices);
  mesh.triangles.reserve(polygons.corners.size() - 2 * polygons.polygons());
  const bool uvs = !polygons.uvCorners.empty();
  std::vector<Triangle> local;
  for (std::size_t p = 0; p < polygons.polygons(); ++p) {
    if (p % 1024 == 0) throwIfCancelled();
    const int begin = polygons.start[p], count = polygons.start[p + 1] - begin;
    const int* corners = polygons.corners.data() + begin;
    triangulatePolygon(mesh.vertices, corners, count, local);
    for (const Triangle& t : local) {
      mesh.triangles.push_back({corners[t[0]], corners[t[1]], corners[t[2]]});
      if (uvs)
        mesh.uvTriangles.push_back({polygons.uvCorners[begin + t[0]],
                                    polygons.uvCorners[begin + t[1]],
                                    polygons.uvCorners[begin + t[2]]});
    }
  }
  if (uvs) mesh.uvs = std::move(polygons.uvs);
  mesh.colours = std::move(polygons.colours);
  if (polygons.corners.size() != 3 * polygons.polygons()) {
    mesh.polygonStart = std::move(polygons.start);
    mesh.polygonCorners = std::move(polygons.corners);
  }
  return mesh;
}

Mesh toMeshLike(PolygonMesh&& polygons, const std::string& path, const Mesh& reference) {
  const bool uvs = !polygons.uvCorners.empty();
  PolygonMesh kept;
  if (uvs) {
    kept.start = polygons.start;
    kept.corners = polygons.corners;
    kept.uvCorners = polygons.uvCorners;
  }
  Mesh mesh = toMesh(std::move(polygons), path);
  const bool comparePolygons = !mesh.polygonStart.empty() && !reference.polygonStart.empty();
  requireEqual(mesh, reference, comparePolygons);
  if (comparePolygons && mesh.triangles != reference.triangles) {
    mesh.triangles = reference.triangles;
    if (uvs) mesh.uvTriangles = recutUvs(kept, mesh.triangles);
  }
  mesh.polygonStart = reference.polygonStart;
  mesh.polygonCorners = reference.polygonCorners;
  return mesh;
}

}  // namespace innermap
