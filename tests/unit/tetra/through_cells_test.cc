#include <gtest/gtest.h>

#include "innermap/core/error.h"
#include "innermap/tetra/cells.h"
#include "innermap/tetra/remesh_cells.h"
#include "innermap/tetra/tetrahedralize.h"
#include "tetra/mapped_balls.h"

namespace innermap {
namespace {

TetrahedralizeSettings coarse() { return {.resolution = 10}; }

CellMesh carriedBall(const MappedSolid& mapped) {
  return remeshCells(tetrahedralize(mapped.solid(), coarse()), mapped).mesh;
}

TEST(ThroughCells, AgreesWithAnAffineMap) {
  const MappedSolid mapped = test::affineBall();
  const LinearCellMap map = linearMapOf(carriedBall(mapped), mapped);
  const Points inside{{0, 0, 0}, {0.3, 0.2, -0.4}, {-0.5, 0.1, 0.2}}, far{{3, 0, 0}};
  const PointCarry push = carryThrough(map, true, {}), pull = carryThrough(map, false, {});
  const CarriedPoints there = push(inside, true), back = pull(there.points, false);
  ASSERT_EQ(there.jacobians.size(), inside.size());
  for (std::size_t i = 0; i < inside.size(); ++i) {
    EXPECT_LT(norm(there.points[i] - affineMap(inside[i])), 1e-9);
    EXPECT_LT(norm(back.points[i] - inside[i]), 1e-9);
    EXPECT_EQ(there.fates[i], PointFate::carried);
  }
  EXPECT_EQ(there.cut + there.outside, 0u);
  const CarriedPoints cut = push(far, false);
  EXPECT_EQ(cut.fates[0], PointFate::cut);
  EXPECT_EQ(cut.cut, 1u);

  Points images;
  std::vector<Mat3> jacobians;
  throughMap(map).pull(there.points, images, jacobians);
  ASSERT_EQ(images.size(), inside.size());
  EXPECT_LT(norm(images[1] - inside[1]), 1e-9);
}

TEST(ThroughCells, RefusesAMeshOfAnotherSolid) {
  const MappedSolid mapped = test::affineBall();
  CellMesh elsewhere = carriedBall(mapped);
  for (Vec3& p : elsewhere.vertices) p.x += 10;
  EXPECT_THROW(linearMapOf(elsewhere, mapped), DataError);
}

}  // namespace
}  // namespace innermap
