#include "fit/target_shape.h"

#include <gtest/gtest.h>

#include "fit/test_pairs.h"

namespace innermap {
namespace {

TEST(TargetShape, KnowsItsInsideAndItsSurface) {
  const Mesh source = ball(4);
  const TargetShape shape(makeBoundaryPair(source, moved(source, [](const Vec3& p) {
                                             return 2 * p + Vec3{5, 0, 0};
                                           })));
  EXPECT_EQ(shape.orientation(), 1);
  EXPECT_TRUE(shape.inside({5, 0, 1.9}));
  EXPECT_FALSE(shape.inside({5, 0, 2.1}));
  EXPECT_TRUE(shape.near({5, 0, 1.9}, 0.12));
  EXPECT_FALSE(shape.near({5, 0, 1.9}, 0.08));
  for (const Vec3& p : {Vec3{5, 0, 0}, Vec3{5, 0, 2}, Vec3{0, 0, 0}})
    EXPECT_FALSE(shape.runsThroughItself(p, 1));
}

TEST(TargetShape, AMirroredTargetHasAnInside) {
  const Mesh source = ball(3);
  const TargetShape shape(makeBoundaryPair(source, moved(source, [](const Vec3& p) {
                                             return Vec3{-p.x, p.y, p.z};
                                           })));
  EXPECT_EQ(shape.orientation(), -1);
  EXPECT_TRUE(shape.inside({0.5, 0, 0}));
  EXPECT_FALSE(shape.inside({1.5, 0, 0}));
}

// Two balls that come to lie 1 from each other: they share a lens about the origin and cross along
// a circle of radius sqrt(3) / 2 about the x axis.
TEST(TargetShape, KnowsWhereItRunsThroughItself) {
  const TargetShape shape(makeBoundaryPair(twoBalls(1.5), twoBalls(0.5)));
  EXPECT_TRUE(shape.runsThroughItself({0, 0, 0}, 0));
  EXPECT_TRUE(shape.runsThroughItself({0.2, 0.3, 0.1}, 0));
  EXPECT_FALSE(shape.runsThroughItself({1, 0, 0}, 0));
  EXPECT_FALSE(shape.runsThroughItself({-1, 0.4, 0}, 0));
  EXPECT_FALSE(shape.runsThroughItself({0, 1, 0}, 0));  // outside, beside the circle
  EXPECT_TRUE(shape.runsThroughItself({0, 1, 0}, 0.2));
}

}  // namespace
}  // namespace innermap
