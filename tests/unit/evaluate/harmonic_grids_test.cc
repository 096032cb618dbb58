#include <gtest/gtest.h>

#include "core/expect.h"
#include "innermap/core/error.h"
#include "innermap/evaluate/grids.h"
#include "mesh/shapes.h"

namespace innermap {
namespace {

// x - 2 y in one channel, a constant in the other.
HarmonicField affineField() {
  Affine affine{{}, Matrix(4, 2)};
  affine.coefficients(1, 0) = 1;
  affine.coefficients(2, 0) = -2;
  affine.coefficients(0, 1) = 5;
  return {Points{{4, 0, 0}}, Matrix(1, 2), affine};
}

TEST(HarmonicGrids, ValuesGradientsDirectionsAndMagnitudes) {
  const Solid solid(shapes::icosphere(2));
  const HarmonicGrids grids =
      evaluateHarmonic(affineField(), solid, {"a", "b"}, {.resolution = 24});
  ASSERT_EQ(grids.fields.size(), 8u);
  const auto value = openvdb::gridPtrCast<openvdb::FloatGrid>(grids.fields[0]);
  const auto gradient = openvdb::gridPtrCast<openvdb::Vec3SGrid>(grids.fields[1]);
  const auto direction = openvdb::gridPtrCast<openvdb::Vec3SGrid>(grids.fields[2]);
  const auto magnitude = openvdb::gridPtrCast<openvdb::FloatGrid>(grids.fields[3]);
  EXPECT_EQ(direction->getName(), "a_direction");
  EXPECT_EQ(value->activeVoxelCount(), grids.activeVoxels);
  std::size_t voxels = 0;
  for (auto voxel = value->cbeginValueOn(); voxel; ++voxel, ++voxels) {
    const openvdb::Vec3d p = value->indexToWorld(voxel.getCoord());
    ASSERT_NEAR(*voxel, p.x() - 2 * p.y(), 1e-5);
    const openvdb::Vec3f g = gradient->tree().getValue(voxel.getCoord());
    ASSERT_NEAR((g - openvdb::Vec3f(1, -2, 0)).length(), 0, 1e-5);
    ASSERT_NEAR(direction->tree().getValue(voxel.getCoord()).length(), 1, 1e-5);
    ASSERT_NEAR(magnitude->tree().getValue(voxel.getCoord()), std::sqrt(5.0), 1e-5);
  }
  EXPECT_GT(voxels, grids.interiorVoxels);
  // No direction where there is none.
  const auto flat = openvdb::gridPtrCast<openvdb::Vec3SGrid>(grids.fields[6]);
  for (auto voxel = flat->cbeginValueOn(); voxel; ++voxel) ASSERT_EQ((*voxel).length(), 0);
}

TEST(HarmonicGrids, OnlyWhatIsAskedFor) {
  const Solid solid(shapes::icosphere(2));
  HarmonicGridSettings settings{.resolution = 16};
  settings.gradients = settings.directions = settings.magnitudes = false;
  EXPECT_EQ(evaluateHarmonic(affineField(), solid, {"a", "b"}, settings).all().size(), 4u);
}

TEST(HarmonicGrids, SayWhatTheFieldIs) {
  const auto grids =
      evaluateHarmonic(affineField(), Solid(shapes::icosphere(2)), {"a", "b"}, {.resolution = 16});
  describeField(grids.all(), {{"span", "3"}});
  for (const openvdb::GridBase::Ptr& grid : grids.all())
    EXPECT_EQ(grid->metaValue<std::string>("innermap_span"), "3");
}

TEST(HarmonicGrids, RefusesBadNamesAndSettings) {
  const Solid solid(shapes::icosphere(1));
  for (const std::vector<std::string>& names :
       {std::vector<std::string>{"a"}, {"a", ""}, {"a", "a"}, {"surface", "b"}})
    EXPECT_THROW(evaluateHarmonic(affineField(), solid, names), SettingError);
  EXPECT_THROW(evaluateHarmonic(affineField(), solid, {"a", "b"}, {.accuracy = 1}), SettingError);
  test::expectOverLimit(1000, [&] { evaluateHarmonic(affineField(), solid, {"a", "b"}, {}); });
}

}  // namespace
}  // namespace innermap
