#include <gtest/gtest.h>

#include "innermap/transfer/carry.h"
#include "transfer/test_maps.h"

namespace innermap {
namespace {

using namespace test;

TEST(CarryMemory, GrowsWithVoxelsGridsAndWhatIsAround) {
  auto grid = openvdb::FloatGrid::create();
  grid->setTransform(openvdb::math::Transform::createLinearTransform(0.5));
  grid->denseFill(openvdb::CoordBBox(openvdb::Coord(-20), openvdb::Coord(20)), 1);
  auto finer = openvdb::DoubleGrid::create();
  finer->setTransform(openvdb::math::Transform::createLinearTransform(0.125));
  EXPECT_DOUBLE_EQ(finestVoxel({grid, finer}), 0.125);
  EXPECT_EQ(finestVoxel({}), 0);
  const Solid solid(ball());
  LevelSetSettings coarse, fine;
  coarse.resolution = 64;
  fine.resolution = 256;
  EXPECT_LT(carryMemory(solid, {grid}, coarse), carryMemory(solid, {grid}, fine));
  EXPECT_LT(carryMemory(solid, {grid}, fine), carryMemory(solid, {grid, finer}, fine));
  EXPECT_LT(carryMemory(solid, {grid}, fine), carryMemory(solid, {grid}, fine, {.distance = 0.5}));
  const CarryKind pulled{false, 0}, withField{true, 1};
  const std::uint64_t pushed = carryMemory(solid, {grid}, fine);
  EXPECT_LT(carryMemory(solid, {grid}, fine, {}, {}, pulled), pushed);
  EXPECT_LT(carryMemory(solid, {grid}, fine, {}, {}, pulled),
            carryMemory(solid, {grid}, fine, {}, {.allDensities = true}));
  EXPECT_GT(carryMemory(solid, {grid}, fine, {}, {}, withField), pushed);
}

}  // namespace
}  // namespace innermap
