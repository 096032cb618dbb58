#include "innermap/lattice/cell_mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <functional>
#include <limits>

#include "innermap/core/error.h"
#include "innermap/core/run.h"
#include "lattice/cell_signs.h"

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

constexpr int kTetFaces[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
constexpr int kHexFaces[6][4] = {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4},
                                 {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};

// Corners of face f, counted over all cells, as seen from outside; the last is -1 for a triangle.
std::array<int, 4> cornersOf(const CellMesh& mesh, std::size_t f) {
  if (f < 4 * mesh.tetrahedra.size()) {
    const Tetrahedron& c = mesh.tetrahedra[f / 4];
    const auto& k = kTetFaces[f % 4];
    return {c[k[0]], c[k[1]], c[k[2]], -1};
  }
  f -= 4 * mesh.tetrahedra.size();
  const Hexahedron& c = mesh.hexahedra[f / 6];
  const auto& k = kHexFaces[f % 6];
  return {c[k[0]], c[k[1]], c[k[2]], c[k[3]]};
}

struct Face {
  std::array<int, 3>
      others;  // its vertices but the lowest, descending; the last is -1 for a triangle
  std::uint32_t number;
};

// Calls use(face, lowest vertex).
template <class Use>
void forEachFace(const CellMesh& mesh, const Use& use) {
  const std::size_t count = 4 * mesh.tetrahedra.size() + 6 * mesh.hexahedra.size();
  for (std::size_t f = 0; f < count; ++f) {
    std::array<int, 4> key = cornersOf(mesh, f);
    const int corners = key[3] < 0 ? 3 : 4;
    std::sort(key.begin(), key.begin() + corners, std::greater<int>());
    const int lowest = key[corners - 1];
    key[corners - 1] = -1;
    use(Face{{key[0], key[1], key[2]}, static_cast<std::uint32_t>(f)}, lowest);
  }
}

// Whether the two are seen in opposite senses: from the two sides.
bool facesOpposite(const CellMesh& mesh, std::uint32_t a, std::uint32_t b) {
  const auto ascending = [&](std::uint32_t f) {
    const std::array<int, 4> c = cornersOf(mesh, f);
    // Of a triangle; a quadrilateral's sense is that of its first corner's neighbours.
    const auto low = std::min_element(c.begin(), c.end() - (c[3] < 0 ? 1 : 0)) - c.begin();
    const int n = c[3] < 0 ? 3 : 4;
    return c[(low + 1) % n] < c[(low + n - 1) % n];
  };
  return ascending(a) != ascending(b);
}

struct Faces {
  std::vector<std::uint32_t> single;  // numbers of those of one cell alone, ascending
  bool paired = true;  // if asked for: all others belong to two cells, one on either side
};

// Faces are gathered by their lowest vertex, where equal ones meet.
Faces facesOf(const CellMesh& mesh, bool pairs) {
  if (4 * mesh.tetrahedra.size() + 6 * mesh.hexahedra.size() >
      std::numeric_limits<std::uint32_t>::max())
    throw MemoryError((mesh.name.empty() ? "mesh" : mesh.name) +
                      ": its boundary is not looked for: it has over four billion faces");
  std::vector<std::size_t> start(mesh.vertices.size() + 1, 0);
  forEachFace(mesh, [&](const Face&, int lowest) { ++start[lowest + 1]; });
  for (std::size_t v = 1; v < start.size(); ++v) start[v] += start[v - 1];
  std::vector<Face> faces(start.back());
  std::vector<std::size_t> next(start.begin(), start.end() - 1);
  forEachFace(mesh, [&](const Face& face, int lowest) { faces[next[lowest]++] = face; });
  constexpr std::size_t kBlock = 4096;
  std::vector<std::vector<std::uint32_t>> found(mesh.vertices.size() / kBlock + 1);
  std::atomic<bool> paired{true};
  parallelBlocks(mesh.vertices.size(), kBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      const auto first = faces.begin() + start[v], last = faces.begin() + start[v + 1];
      std::sort(first, last, [](const Face& a, const Face& b) { return a.others < b.others; });
      for (auto f = first, after = f; f != last; f = after) {
        for (after = f + 1; after != last && after->others == f->others; ++after) {
        }
        if (after == f + 1)
          found[begin / kBlock].push_back(f->number);
        else if (pairs && (after != f + 2 || !facesOpposite(mesh, f->number, (f + 1)->number)))
          paired = false;
      }
    }
  });
  Faces out;
  for (const auto& some : found) out.single.insert(out.single.end(), some.begin(), some.end());
  std::sort(out.single.begin(), out.single.end());
  out.paired = paired;
  return out;
}

// Of the single faces, quadrilaterals cut in two.
std::vector<Triangle> trianglesOf(const CellMesh& mesh, const Faces& faces) {
  std::vector<Triangle> triangles;
  for (const std::uint32_t face : faces.single) {
    const std::array<int, 4> c = cornersOf(mesh, face);
    triangles.push_back({c[0], c[1], c[2]});
    if (c[3] >= 0) triangles.push_back({c[0], c[2], c[3]});
  }
  return triangles;
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

CellBoundary cellBoundary(const CellMesh& mesh) {
  const Faces faces = facesOf(mesh, true);
  return {trianglesOf(mesh, faces), faces.paired};
}

std::vector<Triangle> boundaryTriangles(const CellMesh& mesh) {
  return trianglesOf(mesh, facesOf(mesh, false));
}

}  // namespace innermap
