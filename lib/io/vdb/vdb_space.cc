// Grids in other axes and units.

#include <type_traits>

#include "evaluate/topology.h"
#include "innermap/core/error.h"
#include "innermap/core/run.h"
#include "innermap/io/vdb_file.h"
#include "levelset/set_metadata.h"
#include "transfer/moved_vector.h"

namespace innermap {
namespace {

using openvdb::Coord;

// Index space is turned with the world, so that axes of grids stay along those of the world:
// programs that draw grids only so take them. The last bits make leaves go onto leaves, and tiles
// onto tiles: 8 a to 8 a + 7 becomes -8 a - 8 to -8 a - 1.
Coord turned(const Coord& c, int quarters) {
  if (quarters == 0) return c;
  return quarters > 0 ? Coord(c.x(), -1 - c.z(), c.y()) : Coord(c.x(), c.z(), -1 - c.y());
}

openvdb::Mat4d rowMatrix(const Similarity& by) {
  const Mat3 m = by.matrix();
  openvdb::Mat4d out = openvdb::Mat4d::identity();
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) out[row][column] = m[column][row];
  return out;
}

// From turned indices back, as row vectors.
openvdb::Mat4d indicesBack(int quarters) {
  openvdb::Mat4d out = openvdb::Mat4d::identity();
  if (quarters == 0) return out;
  const Vec3 shift = quarters > 0 ? Vec3{0, 1, 0} : Vec3{0, 0, 1};
  const Similarity back{-quarters, 1};
  out = rowMatrix(back);
  const Vec3 moved = back(shift);
  for (int a = 0; a < 3; ++a) out[3][a] = moved[a];
  return out;
}

template <class Grid>
class GridMover {
 public:
  using Value = typename Grid::ValueType;
  using Tree = typename Grid::TreeType;
  using Leaf = typename Tree::LeafNodeType;

  GridMover(const Grid& grid, const Similarity& by)
      : grid_(grid), by_(by), matrix_(by.matrix()), type_(grid.getVectorType()) {}

  openvdb::GridBase::Ptr run() const {
    const Tree& tree = grid_.constTree();
    auto out = Grid::create(moved(tree.background()));
    moveTiles(tree, out->tree());
    std::size_t done = 0;
    const auto leaves = static_cast<double>(tree.leafCount());
    for (auto leaf = tree.cbeginLeaf(); leaf; ++leaf) {
      if (done++ % 1024 == 0)
        reportProgress("turning the grids", static_cast<double>(done) / leaves);
      moveLeaf(*leaf, out->tree());
    }
    out->insertMeta(grid_);
    return out;
  }

 private:
  Value moved(const Value& value) const {
    if constexpr (std::is_floating_point_v<Value>) {
      return grid_.getGridClass() == openvdb::GRID_LEVEL_SET ? static_cast<Value>(value * by_.scale)
                                                             : value;
    } else if constexpr (openvdb::VecTraits<Value>::IsVec &&
                         !std::is_same_v<Value, openvdb::Vec3i>) {
      const Vec3 v{value[0], value[1], value[2]};
      const Vec3 w =
          type_ == openvdb::VEC_CONTRAVARIANT_ABSOLUTE ? by_(v) : movedVector(v, matrix_, type_);
      return Value(openvdb::Vec3d(w.x, w.y, w.z));
    } else {
      return value;
    }
  }

  void moveTiles(const Tree& from, Tree& to) const {
    auto tile = from.cbeginValueAll();
    tile.setMaxDepth(tile.getLeafDepth() - 1);
    for (; tile; ++tile) {
      if (!tile.isValueOn() && tile.getValue() == from.background()) continue;
      openvdb::CoordBBox box, image;
      tile.getBoundingBox(box);
      image.expand(turned(box.min(), by_.quarters));
      image.expand(turned(box.max(), by_.quarters));
      to.fill(image, moved(tile.getValue()), tile.isValueOn());
    }
  }

  void moveLeaf(const Leaf& from, Tree& to) const {
    const Coord a = turned(from.origin(), by_.quarters);
    Leaf& leaf = *to.touchLeaf(a);
    for (openvdb::Index i = 0; i < Leaf::SIZE; ++i) {
      const Coord at = turned(from.offsetToGlobalCoord(i), by_.quarters);
      const openvdb::Index j = Leaf::coordToOffset(at);
      leaf.setValueOnly(j, moved(from.getValue(i)));
      leaf.setActiveState(j, from.isValueOn(i));
    }
  }

  const Grid& grid_;
  const Similarity by_;
  const Mat3 matrix_;
  const openvdb::VecType type_;
};

openvdb::GridBase::Ptr movedGrid(const openvdb::GridBase& grid, const Similarity& by) {
  if (!grid.transform().isLinear())
    throw DataError(
        "grid '" + grid.getName() +
        "' lies in a frustum, whose axes and unit cannot be changed; resample it first");
  if (by.quarters != 0 && grid.getGridClass() == openvdb::GRID_STAGGERED)
    throw DataError("grid '" + grid.getName() +
                    "' is staggered and cannot be turned; write it with values at voxels' middles");
  openvdb::GridBase::Ptr out;
  grid.apply<GridTypes>(
      [&](const auto& typed) { out = GridMover<std::decay_t<decltype(typed)>>(typed, by).run(); });
  if (!out) throw DataError("grid '" + grid.getName() + "' is of a type that cannot be moved");
  const openvdb::Mat4d matrix = indicesBack(by.quarters) *
                                grid.transform().baseMap()->getAffineMap()->getMat4() *
                                rowMatrix(by);
  out->setTransform(openvdb::math::Transform::createLinearTransform(matrix));
  return out;
}

}  // namespace

void moveGrids(openvdb::GridPtrVec& grids, const Similarity& by) {
  if (by.isIdentity()) return;
  for (openvdb::GridBase::Ptr& grid : grids) grid = movedGrid(*grid, by);
}

void sayInGrids(const openvdb::GridPtrVec& grids, const SpaceSettings& space) {
  for (const openvdb::GridBase::Ptr& grid : grids) {
    setMetadata(*grid, "innermap_up",
                openvdb::StringMetadata(space.upOfOutput() == UpAxis::z ? "z" : "y"));
    setMetadata(*grid, "innermap_metres_per_unit", openvdb::DoubleMetadata(space.unitOfOutput()));
  }
}

}  // namespace innermap
