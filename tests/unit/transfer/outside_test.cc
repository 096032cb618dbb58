#include <gtest/gtest.h>

#include "innermap/core/error.h"
#include "innermap/transfer/carry.h"
#include "transfer/test_maps.h"

namespace innermap {
namespace {

TEST(Outside, FindsTheRigidMotion) {
  const CounterRandom random(3, 0);
  for (int trial = 0; trial < 20; ++trial) {
    const auto number = [&](int k) { return 6 * random.uniform(100 * trial + k) - 3; };
    RigidMotion motion{.rotation = test::rotation(number(0), number(1)),
                       .translation = {number(2), number(3), 1000 * number(4)}};
    Points from, to;
    for (int i = 0; i < 10; ++i) {
      from.push_back({number(5 + 3 * i), number(6 + 3 * i), number(7 + 3 * i)});
      to.push_back(motion(from.back()));
    }
    const RigidMotion found = bestRigidMotion(from, to);
    EXPECT_NEAR(determinant(found.rotation), 1, 1e-12) << "trial " << trial;
    for (std::size_t i = 0; i < from.size(); ++i)
      EXPECT_LT(norm(found(from[i]) - to[i]), 1e-9) << "trial " << trial;
  }
}

// A mirror image has no rigid motion onto it: the best rotation is one still.
TEST(Outside, NeverMirrors) {
  Points from{{1, 0, 0}, {0, 2, 0}, {0, 0, 3}, {-1, -1, 0}}, to = from;
  for (Vec3& p : to) p.x = -p.x;
  EXPECT_NEAR(determinant(bestRigidMotion(from, to).rotation), 1, 1e-12);
}

TEST(Outside, RefusesTooFewPoints) {
  EXPECT_THROW(bestRigidMotion({{0, 0, 0}, {1, 0, 0}}, {{0, 0, 0}, {1, 0, 0}}), DataError);
  EXPECT_THROW(bestRigidMotion(Points(3), Points(4)), DataError);
}

TEST(RigidMotion, IsToldFromOthers) {
  RigidMotion motion;
  EXPECT_TRUE(isRigid(motion));
  motion.rotation = {{{0, -1, 0}, {1, 0, 0}, {0, 0, 1.00001}}};
  EXPECT_TRUE(isRigid(motion));
  motion.rotation[2][2] = -1;  // a reflection
  EXPECT_FALSE(isRigid(motion));
  motion.rotation[2][2] = 1.1;
  EXPECT_FALSE(isRigid(motion));
}

}  // namespace
}  // namespace innermap
