#include <gtest/gtest.h>

#include "innermap/transfer/inverse_map.h"
#include "transfer/test_maps.h"

namespace innermap {
namespace {

using namespace test;

const Mat3 kStretch{{{1.5, 0.2, 0}, {0, 0.8, 0.1}, {0, 0, 1.2}}};
const Vec3 kStep{3, -1, 0.5};

TEST(BackwardDisplacement, LeadsFromEachVoxelToItsPlaceInTheSource) {
  const HarmonicMap map = affineMap(kStretch, kStep);
  const Solid source(ball()), target(moved(ball(), map));
  const auto levelSet = levelSetOf(target, 24);
  const BackwardDisplacement back = backwardDisplacement(ComposedMap(map), source, *levelSet);
  ASSERT_TRUE(back.grid);
  EXPECT_EQ(back.grid->getName(), "displacement");
  EXPECT_EQ(back.grid->getVectorType(), openvdb::VEC_CONTRAVARIANT_RELATIVE);
  EXPECT_EQ(back.grid->transform(), levelSet->transform());
  const Mat3 home = inverse(kStretch);
  std::size_t inside = 0;
  double error = 0;
  const auto distance = levelSet->getConstAccessor();
  for (auto value = back.grid->cbeginValueOn(); value; ++value) {
    if (!(distance.getValue(value.getCoord()) < 0)) continue;
    ++inside;
    const Vec3 at = toVec3(back.grid->indexToWorld(value.getCoord()));
    const Vec3 there = home * (at - kStep);
    const openvdb::Vec3s v = *value;
    error = std::max(error, norm(at + Vec3{v.x(), v.y(), v.z()} - there));
  }
  EXPECT_GT(inside, 2000u);
  EXPECT_LT(error, 1e-5);
  EXPECT_GT(back.statistics.invertedInside(), 0.999);
}

}  // namespace
}  // namespace innermap
