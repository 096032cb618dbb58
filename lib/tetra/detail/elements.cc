#include "tetra/detail/elements.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "innermap/core/memory.h"
#include "innermap/core/run.h"
#include "innermap/tetra/compare_fem.h"
#include "innermap/tetra/tetrahedralize.h"

namespace innermap {

double relativeError(const Vec3& errors, const Vec3& sizes, bool together) {
  if (together) return std::sqrt((errors.x + errors.y + errors.z) / (sizes.x + sizes.y + sizes.z));
  double worst = 0;
  for (int k = 0; k < 3; ++k) worst = std::max(worst, std::sqrt(errors[k] / sizes[k]));
  return worst;
}

std::array<double, 9> gradientIn(const FiniteElements& elements, int cell) {
  const CellMesh& mesh = elements.mesh;
  const Matrix& values = elements.values;
  const Tetrahedron& c = mesh.tetrahedra[cell];
  const std::array<Vec3, 4> g = cornerGradients(mesh.vertices, c);
  std::array<double, 9> out{};
  for (int i = 0; i < 4; ++i)
    for (int k = 0; k < 3; ++k)
      for (int a = 0; a < 3; ++a)
        out[3 * k + a] += values(c[i], static_cast<std::size_t>(k)) * g[i][a];
  return out;
}

double jumpOf(const FiniteElements& e, bool together) {
  constexpr std::size_t kCells = 20000;
  const std::size_t count = e.mesh.tetrahedra.size();
  const std::size_t step = std::max<std::size_t>(1, count / kCells);
  const auto faceOf = [&](std::size_t t, int without) {
    std::array<int, 3> face{};
    for (int i = 0, n = 0; i < 4; ++i)
      if (i != without) face[n++] = e.mesh.tetrahedra[t][i];
    std::sort(face.begin(), face.end());
    return face;
  };
  std::vector<std::pair<std::array<int, 3>, std::size_t>> faces;
  for (std::size_t t = 0; t < count; t += step)
    for (int i = 0; i < 4; ++i) faces.push_back({faceOf(t, i), t});
  std::sort(faces.begin(), faces.end());
  std::vector<bool> concerned(e.mesh.vertices.size(), false);
  for (const auto& face : faces)
    for (const int v : face.first) concerned[v] = true;
  Vec3 jumps, sizes;
  for (std::size_t t = 0; t < count; ++t)
    for (int i = 0; i < 4; ++i) {
      const auto face = faceOf(t, i);
      if (!concerned[face[0]] || !concerned[face[1]] || !concerned[face[2]]) continue;
      auto found = std::lower_bound(faces.begin(), faces.end(), std::pair(face, std::size_t{0}));
      for (; found != faces.end() && found->first == face; ++found) {
        if (found->second == t) continue;
        const auto a = gradientIn(e, static_cast<int>(t));
        const auto b = gradientIn(e, static_cast<int>(found->second));
        for (int k = 0; k < 9; ++k) {
          jumps[k / 3] += (a[k] - b[k]) * (a[k] - b[k]);
          sizes[k / 3] += 0.5 * (a[k] * a[k] + b[k] * b[k]);
        }
      }
    }
  return relativeError(jumps, sizes, together);
}

FiniteElements solveElements(const Solid& solid, const std::function<Vec3(const Vec3&)>& boundary,
                             const ElementsSettings& settings) {
  TetrahedralizeSettings cells;
  cells.resolution = settings.resolution;
  cells.keepTopology = false;
  const auto start = std::chrono::steady_clock::now();
  FiniteElements e;
  Tetrahedralization made = tetrahedralization(solid, cells);
  e.mesh = std::move(made.mesh);
  e.memory = harmonicCellsMemory(e.mesh.vertices.size(), e.mesh.tetrahedra.size());
  requireMemory(fmt::format("finite elements at a resolution of {}", settings.resolution), e.memory,
                "leave out the finest resolution");
  const std::vector<bool> fixed = boundaryVertices(e.mesh);
  Matrix given(e.mesh.vertices.size(), 3);
  parallelBlocks(fixed.size(), 1024, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      if (!fixed[v]) continue;
      const Vec3 value = boundary(e.mesh.vertices[v]);
      for (int k = 0; k < 3; ++k) given(v, static_cast<std::size_t>(k)) = value[k];
    }
  });
  HarmonicCells solved = harmonicOnCells(e.mesh, given);
  e.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  e.edge = made.edge;
  e.unknowns = solved.unknowns;
  e.iterations = solved.iterations;
  e.values = std::move(solved.values);
  e.locator = std::make_unique<CellLocator>(e.mesh.vertices, e.mesh.tetrahedra);
  return e;
}

}  // namespace innermap
