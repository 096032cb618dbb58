#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "core/expect.h"
#include "innermap/tetra/cells.h"

namespace innermap {
namespace {

constexpr Hexahedron kUnit{0, 1, 2, 3, 4, 5, 6, 7};

Points unitCube() {
  return {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
}

TEST(CellQuality, DihedralAnglesOfKnownCells) {
  const Points regular{{1, 1, 1}, {-1, 1, -1}, {1, -1, -1}, {-1, -1, 1}};
  const DihedralRange r = dihedralRange(regular, {0, 1, 2, 3});
  const double angle = std::acos(1.0 / 3) * 180 / std::acos(-1);
  EXPECT_NEAR(r.least, angle, 1e-9);
  EXPECT_NEAR(r.greatest, angle, 1e-9);
  const Points corner{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const DihedralRange c = dihedralRange(corner, {0, 1, 2, 3});
  EXPECT_NEAR(c.least, std::acos(1 / std::sqrt(3.0)) * 180 / std::acos(-1), 1e-9);
  EXPECT_NEAR(c.greatest, 90, 1e-9);
  const DihedralRange inverted = dihedralRange(corner, {0, 2, 1, 3});
  EXPECT_LT(inverted.least, 1e-12);
  EXPECT_NEAR(inverted.greatest, 180, 1e-12);
}

TEST(CellQuality, ScaledJacobianOfKnownCells) {
  Points p = unitCube();
  EXPECT_NEAR(scaledJacobian(p, kUnit), 1, 1e-12);
  for (Vec3& v : p) v.x *= 7;  // a box is as good
  EXPECT_NEAR(scaledJacobian(p, kUnit), 1, 1e-12);
  for (Vec3& v : p) v.x += v.y;  // sheared by 45 degrees
  EXPECT_NEAR(scaledJacobian(p, kUnit), std::sqrt(0.5), 1e-12);
  p = unitCube();
  p[6] = {0.2, 0.2, 0.2};  // dented beyond the plane of its neighbours
  EXPECT_LT(scaledJacobian(p, kUnit), 0);
}

TEST(CellQuality, CountsAndFields) {
  CellMesh mesh{.vertices = unitCube()};
  mesh.tetrahedra = {{0, 1, 3, 4}, {0, 3, 1, 4}};  // the second is inverted
  mesh.hexahedra = {kUnit};
  const CellQuality q = cellQuality(mesh);
  EXPECT_EQ(q.invertedTetrahedra, 1u);
  EXPECT_EQ(q.invertedHexahedra, 0u);
  EXPECT_LT(q.dihedral.least, 1e-6);
  EXPECT_NEAR(q.greatestAngle, 180, 1e-4);
  EXPECT_EQ(
      std::accumulate(q.dihedral.histogram.begin(), q.dihedral.histogram.end(), std::size_t(0)),
      2u);
  EXPECT_EQ(q.dihedral.histogram.front(), 1u);
  EXPECT_EQ(q.jacobian.histogram.back(), 1u);
  setQualityFields(mesh, q);
  setQualityFields(mesh, q);  // those of before are gone
  ASSERT_EQ(mesh.cellFields.size(), 3u);
  EXPECT_NO_THROW(validate(mesh));
  EXPECT_NEAR(mesh.cellFields[2].values[2], 1, 1e-6);
  mesh.hexahedra[0] = {4, 5, 6, 7, 0, 1, 2, 3};
  EXPECT_EQ(cellQuality(mesh).invertedHexahedra, 1u);
}

TEST(CellQuality, EmptyAndCancelled) {
  EXPECT_EQ(cellQuality({}).invertedTetrahedra, 0u);
  CellMesh mesh;
  setQualityFields(mesh, cellQuality(mesh));
  EXPECT_TRUE(mesh.cellFields.empty());
  mesh.vertices = unitCube();
  mesh.hexahedra = {kUnit};
  test::expectCancels([&] { cellQuality(mesh); });
}

}  // namespace
}  // namespace innermap
