#include "evaluate/active_region.h"

#include <gtest/gtest.h>

#include "core/memory_limit.h"
#include "innermap/core/error.h"
#include "innermap/levelset/level_set.h"
#include "mesh/shapes.h"

namespace innermap {
namespace {

openvdb::FloatGrid::Ptr ball(int resolution) {
  LevelSetSettings settings;
  settings.resolution = resolution;
  return makeLevelSet(Solid(shapes::icosphere(3)), settings);
}

TEST(ActiveRegion, HoldsTheInsideAndTheSkin) {
  const auto grid = ball(48);
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
  const auto grid = ball(32);
  RegionSettings wide;
  wide.skin = 5;
  EXPECT_THROW(activeRegion(*grid, wide), SettingError);
  RegionSettings large;
  large.bytesPerVoxel = 100;
  {
    const MemoryLimit limit(100000);
    EXPECT_THROW(activeRegion(*grid, large), MemoryError);
  }
}

}  // namespace
}  // namespace innermap
