#include "innermap/tetra/cell_mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <utility>

#include "innermap/core/error.h"
#include "innermap/core/parallel.h"

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

// All faces by number: four of each tetrahedron, then six of each hexahedron, as seen from outside;
// the last corner is -1 for a triangle.
class Faces {
 public:
  explicit Faces(const CellMesh& mesh) : mesh_(mesh) {}

  std::size_t size() const { return 4 * mesh_.tetrahedra.size() + 6 * mesh_.hexahedra.size(); }

  std::array<int, 4> operator[](std::size_t face) const {
    static constexpr int kTet[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
    static constexpr int kHex[6][4] = {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4},
                                       {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};
    const std::size_t ofTets = 4 * mesh_.tetrahedra.size();
    if (face < ofTets) {
      const Tetrahedron& c = mesh_.tetrahedra[face / 4];
      const auto& f = kTet[face % 4];
      return {c[f[0]], c[f[1]], c[f[2]], -1};
    }
    const Hexahedron& c = mesh_.hexahedra[(face - ofTets) / 6];
    const auto& f = kHex[(face - ofTets) % 6];
    return {c[f[0]], c[f[1]], c[f[2]], c[f[3]]};
  }

  // Corners in ascending order, -1 last.
  std::array<int, 4> key(std::size_t face) const {
    std::array<int, 4> key = (*this)[face];
    std::sort(key.begin(), key.end(),
              [](int a, int b) { return static_cast<unsigned>(a) < static_cast<unsigned>(b); });
    return key;
  }

 private:
  const CellMesh& mesh_;
};

// Whether each face belongs to one cell only: faces are compared with those of the same lowest
// vertex.
std::vector<char> singleFaces(const CellMesh& mesh, const Faces& faces) {
  std::vector<std::size_t> first(mesh.vertices.size() + 1, 0);
  for (std::size_t f = 0; f < faces.size(); ++f) ++first[faces.key(f)[0] + 1];
  std::partial_sum(first.begin(), first.end(), first.begin());
  std::vector<std::size_t> sorted(faces.size()), next(first.begin(), first.end() - 1);
  for (std::size_t f = 0; f < faces.size(); ++f) sorted[next[faces.key(f)[0]]++] = f;
  std::vector<char> single(faces.size(), 0);
  parallelBlocks(mesh.vertices.size(), 4096, [&](std::size_t begin, std::size_t end) {
    std::vector<std::pair<std::array<int, 4>, std::size_t>> of;
    for (std::size_t v = begin; v < end; ++v) {
      of.clear();
      for (std::size_t i = first[v]; i < first[v + 1]; ++i)
        of.emplace_back(faces.key(sorted[i]), sorted[i]);
      std::sort(of.begin(), of.end());
      for (std::size_t i = 0; i < of.size(); ++i)
        single[of[i].second] = (i == 0 || of[i - 1].first != of[i].first) &&
                               (i + 1 == of.size() || of[i + 1].first != of[i].first);
    }
  });
  return single;
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
  const Faces faces(mesh);
  const std::vector<char> single = singleFaces(mesh, faces);
  std::vector<Triangle> triangles;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    if (!single[f]) continue;
    const auto c = faces[f];
    triangles.push_back({c[0], c[1], c[2]});
    if (c[3] >= 0) triangles.push_back({c[0], c[2], c[3]});
  }
  return triangles;
}

}  // namespace innermap
