#include <algorithm>
#include <cmath>
#include <cstdint>
#include <unordered_map>

#include "core/require_number.h"
#include "innermap/core/error.h"
#include "innermap/tetra/hexahedralize.h"

namespace innermap {
namespace {

void requirePieces(int pieces) { requireNumber("pieces", pieces, {1, 1000}); }

// Vertices of a lattice of pieces, made as they are met.
class LatticeVertices {
 public:
  LatticeVertices(const BlockSet& blocks, int pieces) : blocks_(blocks), pieces_(pieces) {}

  int of(const Block& p) {
    std::uint64_t key = 0;
    for (int a = 2; a >= 0; --a)
      key = key * (static_cast<std::uint64_t>(blocks_.size[a]) * pieces_ + 1) +
            static_cast<std::uint64_t>(p[a]);
    const auto [found, isNew] = numbers_.try_emplace(key, static_cast<int>(points_.size()));
    if (isNew)
      points_.push_back(blocks_.lower +
                        blocks_.edge / pieces_ * Vec3{1.0 * p[0], 1.0 * p[1], 1.0 * p[2]});
    return found->second;
  }

  const Points& points() const { return points_; }

 private:
  const BlockSet& blocks_;
  int pieces_;
  Points points_;
  std::unordered_map<std::uint64_t, int> numbers_;
};

// Squares of the boundary, in the order of the blocks: visit(corners, outward counter-clockwise;
// odd: whether the square is a black one of a chequerboard).
template <class Visit>
void visitSquares(const BlockSet& blocks, int pieces, const Visit& visit) {
  for (std::size_t i = 0; i < blocks.filled.size(); ++i) {
    if (!blocks.filled[i]) continue;
    const Block b = blocks.block(i);
    for (int axis = 0; axis < 3; ++axis)
      for (int side = 0; side < 2; ++side) {
        Block beside = b;
        beside[axis] += side ? 1 : -1;
        if (blocks.at(beside)) continue;
        const int u = (axis + 1) % 3, v = (axis + 2) % 3;
        for (int s = 0; s < pieces; ++s)
          for (int t = 0; t < pieces; ++t) {
            std::array<Block, 4> corners;
            for (int c = 0; c < 4; ++c) {
              Block& p = corners[side ? c : 3 - c];
              p[axis] = (b[axis] + side) * pieces;
              p[u] = b[u] * pieces + s + (c == 1 || c == 2);
              p[v] = b[v] * pieces + t + (c >= 2);
            }
            visit(corners, (b[u] * pieces + s + b[v] * pieces + t) % 2 != 0);
          }
      }
  }
}

// Towards the inside: of each axis the side on which more of the eight pieces around are filled.
Vec3 inwards(const BlockSet& blocks, int pieces, const Block& p) {
  Vec3 sum;
  for (int o = 0; o < 8; ++o) {
    Block b;
    // The outermost layer is empty: p[a] is at least `pieces` on the boundary.
    for (int a = 0; a < 3; ++a) b[a] = (p[a] - 1 + (o >> a & 1)) / pieces;
    if (!blocks.at(b)) continue;
    for (int a = 0; a < 3; ++a) sum[a] += o >> a & 1 ? 1 : -1;
  }
  for (int a = 0; a < 3; ++a) sum[a] = sum[a] > 0 ? 1 : sum[a] < 0 ? -1 : 0;
  return sum;
}

}  // namespace

Block BlockSet::block(std::size_t i) const {
  const auto nx = static_cast<std::size_t>(size[0]), ny = static_cast<std::size_t>(size[1]);
  return {static_cast<int>(i % nx), static_cast<int>(i / nx % ny), static_cast<int>(i / nx / ny)};
}

std::size_t BlockSet::count() const {
  return static_cast<std::size_t>(std::count(filled.begin(), filled.end(), 1));
}

Mesh blockSurface(const BlockSet& blocks, int pieces) {
  requirePieces(pieces);
  Mesh mesh;
  mesh.name = "polycube";
  LatticeVertices vertices(blocks, pieces);
  visitSquares(blocks, pieces, [&](const std::array<Block, 4>& corners, bool odd) {
    std::array<int, 4> v;
    for (int c = 0; c < 4; ++c) v[c] = vertices.of(corners[c]);
    if (odd) std::rotate(v.begin(), v.begin() + 1, v.end());
    mesh.triangles.push_back({v[0], v[1], v[2]});
    mesh.triangles.push_back({v[0], v[2], v[3]});
  });
  mesh.vertices = vertices.points();
  return mesh;
}

int usualPieces(const BlockSet& blocks) {
  constexpr double kVertices = 3000;  // about one a square
  const double faces = static_cast<double>(blockSurface(blocks, 1).triangles.size()) / 2;
  return std::clamp(static_cast<int>(std::ceil(std::sqrt(kVertices / faces))), 1, kMostBlockPieces);
}

BlockHexahedra blockHexahedra(const BlockSet& blocks, int pieces, double pillow) {
  requirePieces(pieces);
  if (!(pillow > 0 && pillow < 1)) throw SettingError("pillow", "must be above 0 and below 1");
  BlockHexahedra out;
  out.mesh.name = "polycube";
  LatticeVertices vertices(blocks, pieces);
  // Corners as VTK numbers them.
  constexpr int kCorner[8][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                                 {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
  for (std::size_t i = 0; i < blocks.filled.size(); ++i) {
    if (!blocks.filled[i]) continue;
    const Block b = blocks.block(i);
    for (int z = 0; z < pieces; ++z)
      for (int y = 0; y < pieces; ++y)
        for (int x = 0; x < pieces; ++x) {
          Hexahedron cell;
          for (int c = 0; c < 8; ++c)
            cell[c] =
                vertices.of({b[0] * pieces + x + kCorner[c][0], b[1] * pieces + y + kCorner[c][1],
                             b[2] * pieces + z + kCorner[c][2]});
          out.mesh.hexahedra.push_back(cell);
        }
  }
  out.core = out.mesh.hexahedra.size();
  out.mesh.vertices = vertices.points();
  std::vector<int> outerOf(out.mesh.vertices.size(), -1);
  visitSquares(blocks, pieces, [&](const std::array<Block, 4>& corners, bool) {
    Hexahedron cell;
    for (int c = 0; c < 4; ++c) {
      const int inner = vertices.of(corners[c]);
      if (outerOf[inner] < 0) {
        outerOf[inner] = static_cast<int>(out.mesh.vertices.size());
        out.skin.push_back({outerOf[inner], inner});
        out.mesh.vertices.push_back(out.mesh.vertices[inner]);
        out.mesh.vertices[inner] +=
            pillow * blocks.edge / pieces * inwards(blocks, pieces, corners[c]);
      }
      cell[c] = inner;
      cell[c + 4] = outerOf[inner];
    }
    out.mesh.hexahedra.push_back(cell);
  });
  return out;
}

}  // namespace innermap
