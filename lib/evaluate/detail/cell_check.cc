#include "evaluate/detail/cell_check.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <unordered_map>
#include <utility>
#include <vector>

#include "core/kuhn_cells.h"
#include "core/orientation.h"
#include "evaluate/detail/fold_repair.h"
#include "innermap/core/run.h"
#include "mesh/cover_once.h"

namespace innermap {
namespace {

using openvdb::Coord;
using MapLeaf = openvdb::Vec3STree::LeafNodeType;

constexpr std::size_t kCheckedLeaves = 8;  // that a thread takes at a time
// Faces beyond which overlaps are not looked for: they would take seconds, and half a gigabyte.
constexpr std::size_t kMostFaces = 500000;

using OuterFace = std::array<Coord, 3>;  // of one cell only, outward

// Of one leaf.
struct LeafCells {
  DeterminantFigures determinants;
  std::uint64_t exact = 0;  // signs that took exact arithmetic
  std::vector<OuterFace> faces;
};

// Of the cube's corners.
struct Cube {
  std::array<bool, 8> inside{};
  std::array<Vec3, 8> images;
};

// Reads what one thread looks at.
class Cells {
 public:
  Cells(const openvdb::Vec3fGrid& map, const openvdb::FloatGrid& levelSet,
        const TargetShape& target, double error, const Vec3& origin)
      : map_(map.getConstAccessor()),
        distance_(levelSet.getConstAccessor()),
        target_(target),
        origin_(origin),
        error_(error),
        volume_(std::pow(levelSet.voxelSize()[0], 3)) {}

  LeafCells of(const MapLeaf& leaf) const {
    LeafCells out;
    for (auto voxel = leaf.cbeginValueOn(); voxel; ++voxel) addCube(voxel.getCoord(), out);
    return out;
  }

 private:
  bool inside(const Coord& c) const { return distance_.getValue(c) < 0 && map_.isValueOn(c); }

  void addCube(const Coord& at, LeafCells& out) const {
    if (!inside(at) || !inside(cornerOf(at, 7))) return;  // all cells have these corners
    Cube cube;
    for (int bits = 0; bits < 8; ++bits) {
      const Coord c = cornerOf(at, bits);
      const auto k = static_cast<std::size_t>(bits);
      cube.inside[k] = inside(c);
      const openvdb::Vec3f p = map_.getValue(c);
      cube.images[k] = {p.x(), p.y(), p.z()};
    }
    for (const KuhnCell& cell : kKuhnCells)
      if (cube.inside[static_cast<std::size_t>(cell[1])] &&
          cube.inside[static_cast<std::size_t>(cell[2])])
        addCell(at, cube, cell, out);
  }

  void addCell(const Coord& at, const Cube& cube, const KuhnCell& cell, LeafCells& out) const {
    const auto image = [&](std::size_t i) {
      return cube.images[static_cast<std::size_t>(cell[i])];
    };
    const Vec3 p = image(0), a = image(1) - p, b = image(2) - p, c = image(3) - p;
    const int sense = target_.orientation();
    double determinant = sense * dot(cross(a, b), c) / volume_;
    // The figure is rounded, its sign is not.
    std::uint64_t exact = 0;
    const bool positive = orientation(p, image(1), image(2), image(3), exact) ==
                          (sense < 0 ? Sign::negative : Sign::positive);
    out.exact += exact;
    determinant = positive ? std::max(determinant, std::numeric_limits<double>::min())
                           : std::min(determinant, 0.0);
    out.determinants.add(
        determinant,
        !(determinant > 0) && target_.runsThroughItself(origin_ + p + (a + b + c) / 4, error_));
    addOuterFaces(at, cube, cell, out.faces);
  }

  // The cell beyond a face has the other three corners and, for the one across, the sum of its
  // neighbours along the cell's path from the lowest corner to the highest, less itself: for the
  // two in the middle a corner of the cube.
  void addOuterFaces(const Coord& at, const Cube& cube, const KuhnCell& cell,
                     std::vector<OuterFace>& out) const {
    constexpr std::array<std::array<std::size_t, 3>, 4> kFaces{
        {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};
    const std::size_t low = cell[1] < cell[2] ? 1 : 2, high = 3 - low;
    const Coord first = cornerOf(Coord(), cell[low]),
                last = Coord(1) - cornerOf(Coord(), cell[high]);
    const auto corner = [&](std::size_t i) { return cornerOf(at, cell[i]); };
    const auto add = [&](std::size_t across) {
      const auto& face = kFaces[across];
      out.push_back({corner(face[0]), corner(face[1]), corner(face[2])});
    };
    if (!inside(corner(3) + first)) add(0);
    if (!cube.inside[static_cast<std::size_t>(cell[high] - cell[low])]) add(low);
    if (!cube.inside[static_cast<std::size_t>(cell[low] + 7 - cell[high])]) add(high);
    if (!inside(at - last)) add(3);
  }

  openvdb::Vec3fGrid::ConstAccessor map_;
  openvdb::FloatGrid::ConstAccessor distance_;
  const TargetShape& target_;
  const Vec3 origin_;
  double error_;
  double volume_;
};

std::vector<LeafCells> allCells(const openvdb::Vec3fGrid& map, const openvdb::FloatGrid& levelSet,
                                const TargetShape& target, double error, const Vec3& origin) {
  std::vector<const MapLeaf*> leaves;
  for (auto leaf = map.tree().cbeginLeaf(); leaf; ++leaf) leaves.push_back(&*leaf);
  std::vector<LeafCells> out(leaves.size());
  parallelBlocks(
      leaves.size(), kCheckedLeaves,
      [&](std::size_t begin, std::size_t end) {
        const Cells cells(map, levelSet, target, error, origin);
        for (std::size_t i = begin; i < end; ++i) out[i] = cells.of(*leaves[i]);
      },
      "checking cells");
  return out;
}

// The image of the cells' boundary.
struct OuterImage {
  Points vertices;
  std::vector<Triangle> triangles;

  // Takes the faces away from the leaves.
  OuterImage(std::vector<LeafCells>& leaves, const openvdb::Vec3fGrid& map, bool mirrored) {
    const auto values = map.getConstAccessor();
    std::unordered_map<Coord, int, CoordHash> numbers;
    for (LeafCells& leaf : leaves)
      for (const OuterFace& face : std::exchange(leaf.faces, {})) {
        Triangle t;
        for (std::size_t k = 0; k < 3; ++k) {
          const auto [at, fresh] = numbers.try_emplace(face[k], static_cast<int>(vertices.size()));
          if (fresh) {
            const openvdb::Vec3f p = values.getValue(face[k]);
            vertices.push_back({p.x(), p.y(), p.z()});
          }
          t[k] = at->second;
        }
        if (mirrored) std::swap(t[1], t[2]);
        triangles.push_back(t);
      }
  }
};

// As CellFigures::overlaps has it. Cells of neighbouring cubes meet in whole faces.
std::int64_t overlapsOf(const OuterImage& image) {
  const CoverCheck cover = checkCover(image.vertices, image.triangles);
  if (cover.overlaps()) return static_cast<std::int64_t>(cover.crossings + cover.doubled);
  return cover.once() ? 0 : -1;
}

}  // namespace

CellFigures checkCells(const openvdb::Vec3fGrid& map, const openvdb::FloatGrid& levelSet,
                       const TargetShape& target, double error, const Vec3& origin) {
  std::vector<LeafCells> leaves = allCells(map, levelSet, target, error, origin);
  CellFigures out;
  std::size_t faces = 0;
  for (const LeafCells& leaf : leaves) {
    out.add(leaf.determinants);
    out.exact += leaf.exact;
    faces += leaf.faces.size();
  }
  if (out.checked > 0 && out.folded == 0 && faces <= kMostFaces)
    out.overlaps = overlapsOf(OuterImage(leaves, map, target.orientation() < 0));
  return out;
}

}  // namespace innermap
