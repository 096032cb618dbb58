#include "innermap/core/vec3.h"

#include <gtest/gtest.h>

namespace innermap {
namespace {

TEST(Vec3, CrossIsRightHanded) {
  const Vec3 z = cross(Vec3{1, 0, 0}, Vec3{0, 1, 0});
  EXPECT_DOUBLE_EQ(z.z, 1);
  EXPECT_DOUBLE_EQ(z.x, 0);
}

TEST(Vec3, DeterminantOfRows) {
  EXPECT_DOUBLE_EQ(determinant(Mat3{{{2, 0, 0}, {0, 3, 0}, {0, 0, 4}}}), 24);
  EXPECT_DOUBLE_EQ(determinant(Mat3{{{0, 1, 0}, {1, 0, 0}, {0, 0, 1}}}), -1);
}

TEST(Box3, GrowsByPoints) {
  Box3 box;
  EXPECT_TRUE(box.empty());
  EXPECT_DOUBLE_EQ(box.diagonal(), 0);
  box.add(Vec3{1, 2, 3});
  EXPECT_FALSE(box.empty());
  box.add(Vec3{4, 6, 3});
  EXPECT_DOUBLE_EQ(box.diagonal(), 5);
  EXPECT_DOUBLE_EQ(box.center().y, 4);
}

}  // namespace
}  // namespace innermap
