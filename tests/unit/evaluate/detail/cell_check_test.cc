#include "evaluate/detail/cell_check.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/expect.h"
#include "evaluate/test_lattice.h"

namespace innermap {
namespace {

using openvdb::Coord;
using test::Lattice;

Vec3 unmoved(const Vec3& p) { return p; }

TEST(CellCheck, AnAffineMapTurnsNoCellOver) {
  Lattice lattice(0.5);
  lattice.addBox({-3, 0, 5}, {6, 7, 25}, [](const Vec3& p) { return affineMap(0.5 * p); });
  const CellFigures found = lattice.check();
  EXPECT_EQ(found.checked, 6u * 9 * 7 * 20);
  EXPECT_EQ(found.folded, 0u);
  EXPECT_EQ(found.overlaps, 0);
  const Vec3 o = affineMap({0, 0, 0});
  const double det =
      dot(cross(affineMap({1, 0, 0}) - o, affineMap({0, 1, 0}) - o), affineMap({0, 0, 1}) - o);
  EXPECT_NEAR(found.least, det, 1e-4);
}

// Whole numbers that floats hold: each cell is flat, which sums of products tell of few of them.
TEST(CellCheck, AMapOntoAPlaneTurnsEachCellOver) {
  Lattice lattice;
  const Vec3 a{524287, 300001, -412339}, b{-123457, 498731, 377717};
  lattice.addBox({0, 0, 0}, {7, 7, 7},
                 [&](const Vec3& p) { return p.x * a + p.y * b + p.z * (a + b); });
  const CellFigures found = lattice.check();
  EXPECT_EQ(found.checked, 6u * 7 * 7 * 7);
  EXPECT_EQ(found.folded, found.checked);
  EXPECT_GT(found.exact, 0u);
}

// A voxel is a corner of 24 cells; past the opposite face of its cubes all on that side are over.
TEST(CellCheck, AVoxelOutOfPlaceTurnsCellsOver) {
  Lattice lattice;
  lattice.addBox({0, 0, 0}, {6, 6, 6}, unmoved);
  lattice.map->tree().setValue(Coord(3, 3, 3), openvdb::Vec3f(4.5F, 3, 3));
  const CellFigures found = lattice.check();
  EXPECT_GT(found.folded, 0u);
  EXPECT_LT(found.folded, 24u);
  EXPECT_NEAR(found.least, -0.5, 1e-6);
  EXPECT_EQ(found.overlaps, -1);
}

// A bar bent to a ring: its ends meet after a whole turn and then pass through one another, where
// no cell is turned over.
TEST(CellCheck, ARingThatClosesOverlaps) {
  const auto bent = [](double turns) {
    Lattice lattice;
    lattice.addBox({0, 0, 0}, {100, 4, 4}, [&](const Vec3& p) {
      const double angle = 2 * M_PI * turns * p.x / 100, r = 24.3 - p.y;
      return Vec3{r * std::cos(angle), r * std::sin(angle), p.z + 0.003 * p.x};
    });
    return lattice.check();
  };
  const CellFigures open = bent(0.95), closed = bent(1.05);
  EXPECT_EQ(open.folded, 0u);
  EXPECT_EQ(open.overlaps, 0);
  EXPECT_EQ(closed.folded, 0u);
  EXPECT_GT(closed.overlaps, 0);
}

// Nothing crosses, but the small box lies where the large one is.
TEST(CellCheck, OnePartInsideAnotherOverlaps) {
  Lattice lattice;
  lattice.addBox({0, 0, 0}, {9, 9, 9}, unmoved);
  lattice.addBox({20, 0, 0}, {22, 2, 2}, [](const Vec3& p) { return p + Vec3{-16.7, 3.3, 3.4}; });
  EXPECT_EQ(lattice.check().folded, 0u);
  EXPECT_EQ(lattice.check().overlaps, 1);
  Lattice apart;
  apart.addBox({0, 0, 0}, {9, 9, 9}, unmoved);
  apart.addBox({20, 0, 0}, {22, 2, 2}, unmoved);
  EXPECT_EQ(apart.check().overlaps, 0);
}

// Its inner boundary is wound about once as well.
TEST(CellCheck, AHollowBoxDoesNotOverlap) {
  Lattice lattice;
  lattice.addBox({0, 0, 0}, {9, 9, 9}, unmoved);
  for (const Coord& c : openvdb::CoordBBox(Coord(3, 3, 3), Coord(6, 6, 6)))
    lattice.levelSet->tree().setValue(c, 1.0F);
  const CellFigures found = lattice.check();
  EXPECT_GT(found.checked, 0u);
  EXPECT_EQ(found.overlaps, 0);
}

TEST(CellCheck, NoneWhereNoVoxelsAreNeighbours) {
  Lattice lattice;
  lattice.addBox({0, 0, 0}, {0, 9, 9}, unmoved);
  EXPECT_EQ(lattice.check().checked, 0u);
}

TEST(CellCheck, SameForAnyNumberOfThreadsAndCancels) {
  Lattice lattice;
  lattice.addBox({0, 0, 0}, {30, 30, 30},
                 [](const Vec3& p) { return harmonicPolynomial(0.03 * p); });
  test::expectSameForThreads([&] { return lattice.check().least; });
  test::expectCancels([&] { lattice.check(); });
}

}  // namespace
}  // namespace innermap
