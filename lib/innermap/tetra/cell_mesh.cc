#include "innermap/tetra/cell_mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <tuple>

#include "innermap/core/error.h"

namespace innermap {
namespace {

[[noreturn]] void invalid(const CellMesh& mesh, const std::string& what) {
  throw DataError((mesh.name.empty() ? "mesh" : mesh.name) + ": " + what);
}

template <std::size_t N>
void validateCell(const CellMesh& mesh, const char* kind, std::size_t index,
                  const std::array<int, N>& cell) {
  std::array<int, N> sorted = cell;
  std::sort(sorted.begin(), sorted.end());
  if (sorted.front() < 0 || static_cast<std::size_t>(sorted.back()) >= mesh.vertices.size())
    invalid(mesh,
            fmt::format("{} {} uses vertex {} of {} (counted from 0)", kind, index,
                        sorted.front() < 0 ? sorted.front() : sorted.back(), mesh.vertices.size()));
  if (std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end())
    invalid(mesh, fmt::format("{} {} uses a vertex twice (counted from 0)", kind, index));
  for (const int v : cell)
    if (!isFinite(mesh.vertices[v]))
      invalid(mesh, fmt::format("vertex {} is not finite (counted from 0)", v));
}

void validateFields(const CellMesh& mesh, const std::vector<CellField>& fields, std::size_t rows,
                    const char* of) {
  for (const CellField& field : fields) {
    if (field.components < 1)
      invalid(mesh, fmt::format("field {} has {} components", field.name, field.components));
    if (field.kind != CellField::Kind::scalar && field.components != 3)
      invalid(mesh, fmt::format("field {} is a direction of {} components: it must have 3",
                                field.name, field.components));
    if (field.values.size() != rows * static_cast<std::size_t>(field.components))
      invalid(mesh, fmt::format("field {} has {} values for {} {} of {} components", field.name,
                                field.values.size(), rows, of, field.components));
  }
}

struct Face {
  std::array<int, 4> key;      // sorted; the last is -1 for a triangle
  std::array<int, 4> corners;  // as seen from outside; the last is -1 for a triangle
  std::int64_t order;
};

Face makeFace(std::array<int, 4> corners, std::int64_t order) {
  std::array<int, 4> key = corners;
  std::sort(key.begin(), key.end(), [](int a, int b) {
    return static_cast<unsigned>(a) < static_cast<unsigned>(b);  // -1 last
  });
  return {key, corners, order};
}

std::vector<Face> facesOf(const CellMesh& mesh) {
  static constexpr int kTet[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
  static constexpr int kHex[6][4] = {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4},
                                     {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};
  std::vector<Face> faces;
  faces.reserve(4 * mesh.tetrahedra.size() + 6 * mesh.hexahedra.size());
  std::int64_t order = 0;
  for (const Tetrahedron& c : mesh.tetrahedra)
    for (const auto& f : kTet) faces.push_back(makeFace({c[f[0]], c[f[1]], c[f[2]], -1}, order++));
  for (const Hexahedron& c : mesh.hexahedra)
    for (const auto& f : kHex)
      faces.push_back(makeFace({c[f[0]], c[f[1]], c[f[2]], c[f[3]]}, order++));
  return faces;
}

}  // namespace

void validate(const CellMesh& mesh) {
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
    validateCell(mesh, "tetrahedron", t, mesh.tetrahedra[t]);
  for (std::size_t h = 0; h < mesh.hexahedra.size(); ++h)
    validateCell(mesh, "hexahedron", h, mesh.hexahedra[h]);
  validateFields(mesh, mesh.vertexFields, mesh.vertices.size(), "vertices");
  validateFields(mesh, mesh.cellFields, mesh.tetrahedra.size() + mesh.hexahedra.size(), "cells");
}

double signedVolume(const Points& vertices, const Tetrahedron& cell) {
  const Vec3& a = vertices[cell[0]];
  return dot(vertices[cell[1]] - a, cross(vertices[cell[2]] - a, vertices[cell[3]] - a)) / 6;
}

std::array<Tetrahedron, 8> cornerTetrahedra(const Hexahedron& c) {
  static constexpr int kCorners[8][4] = {{0, 1, 3, 4}, {1, 2, 0, 5}, {2, 3, 1, 6}, {3, 0, 2, 7},
                                         {4, 7, 5, 0}, {5, 4, 6, 1}, {6, 5, 7, 2}, {7, 6, 4, 3}};
  std::array<Tetrahedron, 8> tetrahedra{};
  for (int k = 0; k < 8; ++k)
    for (int i = 0; i < 4; ++i) tetrahedra[k][i] = c[kCorners[k][i]];
  return tetrahedra;
}

std::vector<Triangle> boundaryTriangles(const CellMesh& mesh) {
  std::vector<Face> faces = facesOf(mesh);
  std::sort(faces.begin(), faces.end(), [](const Face& a, const Face& b) {
    return std::tie(a.key, a.order) < std::tie(b.key, b.order);
  });
  std::vector<Face> single;
  for (std::size_t i = 0, end = 0; i < faces.size(); i = end) {
    for (end = i + 1; end < faces.size() && faces[end].key == faces[i].key; ++end) {
    }
    if (end == i + 1) single.push_back(faces[i]);
  }
  std::sort(single.begin(), single.end(),
            [](const Face& a, const Face& b) { return a.order < b.order; });
  std::vector<Triangle> triangles;
  for (const Face& face : single) {
    const auto& c = face.corners;
    triangles.push_back({c[0], c[1], c[2]});
    if (c[3] >= 0) triangles.push_back({c[0], c[2], c[3]});
  }
  return triangles;
}

}  // namespace innermap
