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

TEST(Vec3, ProductsAndInverses) {
  const Mat3 m{{{2, 1, 0}, {-1, 3, 0.5}, {0, 4, 1}}};
  const Vec3 v = m * Vec3{1, 2, 3};
  EXPECT_DOUBLE_EQ(v.x, 4);
  EXPECT_DOUBLE_EQ(v.y, 6.5);
  EXPECT_DOUBLE_EQ(v.z, 11);
  const Mat3 one = product(m, inverse(m)), t = transposed(m);
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(one[r][c], r == c ? 1 : 0, 1e-15);
      EXPECT_DOUBLE_EQ(t[r][c], m[c][r]);
    }
  EXPECT_FALSE(std::isfinite(inverse(Mat3{})[0][0]));
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
