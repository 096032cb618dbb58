#include "evaluate/active_region.h"

#include <gtest/gtest.h>

#include "core/expect.h"
#include "innermap/core/error.h"
#include "innermap/levelset/level_set.h"
#include "mesh/shapes.h"

namespace innermap {
namespace {

openvdb::FloatGrid::Ptr ballGrid(int resolution) {
  return makeLevelSet(Solid(shapes::icosphere(3)), {.resolution = resolution});
}

TEST(ActiveRegion, HoldsTheInsideAndTheSkin) {
  const auto grid = ballGrid(48);
  const double voxel = grid->voxelSize()[0];
  const auto region = activeRegion(*grid);
  auto mask = region->getConstAccessor();
  auto distance = grid->getConstAccessor();
  const openvdb::CoordBBox box = openvdb::CoordBBox(openvdb::Coord(-8), openvdb::Coord(56));
  for (auto ijk = box.begin(); ijk; ++ijk)
    ASSERT_EQ(mask.isValueOn(*ijk), distance.getValue(*ijk) <= 2 * voxel) << *ijk;
  EXPECT_EQ(region->tree().activeTileCount(), 0u);
}

TEST(ActiveRegion, RefusesASkinBeyondTheBandAndTooMuchMemory) {
  const auto grid = ballGrid(32);
  EXPECT_THROW(activeRegion(*grid, {.skin = 5}), SettingError);
  test::expectOverLimit(100000, [&] { activeRegion(*grid, {.bytesPerVoxel = 100}); });
}

}  // namespace
}  // namespace innermap
