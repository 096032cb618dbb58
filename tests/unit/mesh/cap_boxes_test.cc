#include <gtest/gtest.h>

#include "innermap/mesh/check.h"
#include "mesh/test_meshes.h"

namespace innermap {
namespace {

using testing::cube;

TEST(CapBoxes, AClosedMeshHasNone) { EXPECT_TRUE(capBoxes(repair(cube())).empty()); }

// A side of the cube is two triangles: without both a fan closes it, without one a triangle.
TEST(CapBoxes, OneAHoleWhereTheMeshWasOpen) {
  Mesh mesh = cube();
  mesh.triangles.erase(mesh.triangles.begin() + 1,
                       mesh.triangles.begin() + 4);  // half of z = 0, z = 1
  const RepairedMesh repaired = repair(mesh);
  ASSERT_EQ(repaired.caps, 2);
  std::vector<Box3> boxes = capBoxes(repaired);
  ASSERT_EQ(boxes.size(), 2u);
  if (boxes[0].lower.z > boxes[1].lower.z) std::swap(boxes[0], boxes[1]);
  for (int side = 0; side < 2; ++side) {
    EXPECT_NEAR(norm(boxes[side].center() - Vec3{0.5, 0.5, 1.0 * side}), 0, 1e-14);
    EXPECT_NEAR(norm(boxes[side].extent() - Vec3{1, 1, 0}), 0, 1e-14);
  }
}

// Two fans one after the other are two caps.
TEST(CapBoxes, MoveWithTheMesh) {
  Mesh mesh = cube();
  mesh.triangles.erase(mesh.triangles.begin(), mesh.triangles.begin() + 4);
  const RepairedMesh repaired = repair(mesh);
  ASSERT_EQ(repaired.caps, 2);
  Points moved = mesh.vertices;
  for (Vec3& p : moved) p = 3.0 * p + Vec3{1, 2, 3};
  const std::vector<Box3> before = capBoxes(repaired),
                          after = capBoxes(repaired, repairedPositions(repaired, moved));
  ASSERT_EQ(before.size(), 2u);
  ASSERT_EQ(after.size(), 2u);
  for (int k = 0; k < 2; ++k) {
    EXPECT_NEAR(norm(after[k].center() - (3.0 * before[k].center() + Vec3{1, 2, 3})), 0, 1e-13);
    EXPECT_NEAR(after[k].diagonal(), 3 * before[k].diagonal(), 1e-13);
  }
}

}  // namespace
}  // namespace innermap
