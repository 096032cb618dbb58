#include "transfer/cell_locator.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/random.h"
#include "tetra/kuhn_mesh.h"

namespace innermap {
namespace {

TEST(CellLocator, FindsEveryPointOfTheCube) {
  const CellMesh mesh = test::kuhnMesh(5);
  const CellLocator locator(mesh.vertices, mesh.tetrahedra);
  const CounterRandom random(3, 1);
  for (std::uint64_t i = 0; i < 2000; ++i) {
    const Vec3 p{random.uniform(3 * i), random.uniform(3 * i + 1), random.uniform(3 * i + 2)};
    const CellPoint at = locator.locate(p);
    ASSERT_GE(at.tetrahedron, 0);
    EXPECT_GE(*std::min_element(at.barycentric.begin(), at.barycentric.end()), -1e-11);
    EXPECT_LT(norm(valueAt(mesh.vertices, mesh.tetrahedra, at) - p), 1e-12);
    EXPECT_EQ(at.distance, 0);
  }
}

TEST(CellLocator, OutsideTheNearestContinues) {
  const CellMesh mesh = test::kuhnMesh(3);
  const CellLocator locator(mesh.vertices, mesh.tetrahedra);
  const Vec3 p{0.4, 0.6, 1.3};
  const CellPoint at = locator.locate(p);
  EXPECT_NEAR(at.distance, 0.3, 1e-12);
  EXPECT_LT(norm(valueAt(mesh.vertices, mesh.tetrahedra, at) - p), 1e-12);
  const Vec3 near = valueAt(mesh.vertices, mesh.tetrahedra, clamped(at));
  EXPECT_LE(near.z, 1 + 1e-12);
  EXPECT_GT(near.z, 0.6);
}

TEST(CellLocator, LeavesInvertedOnesOut) {
  CellMesh mesh = test::kuhnMesh(1);
  for (Tetrahedron& t : mesh.tetrahedra) std::swap(t[0], t[1]);
  EXPECT_EQ(CellLocator(mesh.vertices, mesh.tetrahedra).locate({0.5, 0.4, 0.3}).tetrahedron, -1);
  std::swap(mesh.tetrahedra[2][0], mesh.tetrahedra[2][1]);
  EXPECT_EQ(CellLocator(mesh.vertices, mesh.tetrahedra).locate({0.5, 0.4, 0.3}).tetrahedron, 2);
}

}  // namespace
}  // namespace innermap
