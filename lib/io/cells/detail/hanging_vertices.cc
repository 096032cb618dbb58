#include "io/cells/detail/hanging_vertices.h"

#include <atomic>
#include <cmath>

#include "core/point_grid.h"
#include "innermap/core/run.h"

namespace innermap {
namespace {

constexpr double kNear = 1e-6;
constexpr std::size_t kBlock = 1024;  // cells

constexpr int kTetEdges[][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};
// Edges, then one diagonal of each face.
constexpr int kHexEdges[][2] = {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {4, 5}, {5, 6},
                                {6, 7}, {7, 4}, {0, 4}, {1, 5}, {2, 6}, {3, 7},
                                {0, 2}, {4, 6}, {0, 5}, {1, 6}, {2, 7}, {3, 4}};

class Search {
 public:
  explicit Search(const CellMesh& mesh)
      : mesh_(mesh), grid_(mesh.vertices, meanEdge(mesh)), hangs_(mesh.vertices.size()) {}

  template <class Cells, std::size_t N>
  void among(const Cells& cells, const int (&edges)[N][2]) {
    parallelBlocks(cells.size(), kBlock, [&](std::size_t begin, std::size_t end) {
      for (std::size_t c = begin; c < end; ++c)
        for (const auto& [a, b] : edges) middle(cells[c][a], cells[c][b]);
    });
  }

  std::uint64_t count() const {
    std::uint64_t out = 0;
    for (const auto& one : hangs_) out += one.load(std::memory_order_relaxed);
    return out;
  }

 private:
  // Of some of the cells: how wide the search's boxes are.
  static double meanEdge(const CellMesh& mesh) {
    double sum = 0;
    std::size_t count = 0;
    const auto add = [&](const auto& cells) {
      for (std::size_t c = 0; c < cells.size(); c += cells.size() / 1000 + 1, ++count)
        sum += norm(mesh.vertices[cells[c][1]] - mesh.vertices[cells[c][0]]);
    };
    add(mesh.tetrahedra);
    add(mesh.hexahedra);
    const double mean = sum / static_cast<double>(count);
    return mean > 1e-300 && std::isfinite(1 / mean) && std::isfinite(mean) ? mean : 1;
  }

  void middle(int a, int b) {
    const Vec3 &from = mesh_.vertices[a], &to = mesh_.vertices[b], at = 0.5 * (from + to);
    const double radius = kNear * norm(to - from);
    if (!(radius > 0) || !grid_.anyNearer(at, radius)) return;
    Box3 box;
    box.add(at);
    for (const std::size_t v : grid_.within(box, radius))
      if (static_cast<int>(v) != a && static_cast<int>(v) != b)
        hangs_[v].store(1, std::memory_order_relaxed);
  }

  const CellMesh& mesh_;
  const PointGrid grid_;
  std::vector<std::atomic<std::uint8_t>> hangs_;
};

}  // namespace

std::uint64_t countHangingVertices(const CellMesh& mesh) {
  Search search(mesh);
  search.among(mesh.tetrahedra, kTetEdges);
  search.among(mesh.hexahedra, kHexEdges);
  return search.count();
}

}  // namespace innermap
