#include <gtest/gtest.h>
#include <openvdb/tools/ChangeBackground.h>

#include <set>

#include "innermap/core/error.h"
#include "innermap/io/pictures.h"
#include "io/test_files.h"

namespace innermap {
namespace {

using namespace test;

openvdb::FloatGrid::Ptr coded() {
  return block<openvdb::FloatGrid>(
      "code", kBox, [](auto c) { return float(10000 * (c.x() + 50) + 100 * c.y() + c.z()); }, 0.5);
}

TEST(Slice, EveryPixelIsItsVoxelAndKnowsItsPlace) {
  const auto grid = coded();
  for (int axis = 0; axis < 3; ++axis) {
    const SliceFrame frame = sliceFrame({grid}, axis);
    EXPECT_EQ(frame.box, kBox);
    for (const int layer : sliceLayers(frame, 3)) {
      const auto channels = sliceGrid(*grid, frame, layer);
      ASSERT_EQ(channels.size(), 1u);
      EXPECT_EQ(channels[0].name, "code.V");
      for (std::size_t row = 0; row < frame.rows(); ++row)
        for (std::size_t column = 0; column < frame.columns(); ++column) {
          const openvdb::Coord at = frame.coord(column, row, layer);
          EXPECT_EQ(channels[0].values[row * frame.columns() + column], grid->tree().getValue(at));
          const Vec3 w = frame.world(column, row, layer);
          EXPECT_EQ(w.x, 0.5 * at.x());
          EXPECT_EQ(w.y, 0.5 * at.y());
          EXPECT_EQ(w.z, 0.5 * at.z());
        }
    }
  }
}

TEST(Slice, ImagesStandUpright) {
  const auto grid = coded();
  const SliceFrame frame = sliceFrame({grid}, 2);
  EXPECT_GT(frame.world(0, 0, 30).y, frame.world(0, 1, 30).y);
  EXPECT_LT(frame.world(0, 0, 30).x, frame.world(1, 0, 30).x);
}

TEST(Slice, LayersAreDistinctSpacedAndInside) {
  const SliceFrame frame = sliceFrame({coded()}, 0);  // 18 layers, from -5 to 12
  EXPECT_EQ(sliceLayers(frame, 1), std::vector<int>{4});
  EXPECT_EQ(sliceLayers(frame, 3), (std::vector<int>{-2, 4, 10}));
  for (int count = 1; count <= 40; ++count) {
    SCOPED_TRACE(count);
    const std::vector<int> layers = sliceLayers(frame, count);
    EXPECT_EQ(layers.size(), static_cast<std::size_t>(std::min(count, 18)));
    EXPECT_EQ(std::set<int>(layers.begin(), layers.end()).size(), layers.size());
    for (const int layer : layers) {
      EXPECT_GE(layer, -5);
      EXPECT_LE(layer, 12);
    }
    for (std::size_t i = 2; i < layers.size(); ++i)
      EXPECT_LE(std::abs((layers[i] - layers[i - 1]) - (layers[1] - layers[0])), 1);
  }
}

TEST(Slice, InactiveIsZeroButLevelSetsKeepTheirInside) {
  auto grid = block<openvdb::FloatGrid>("v", kBox, [](auto) { return 3.0f; });
  openvdb::tools::changeBackground(grid->tree(), 7.0f);
  grid->tree().setActiveState(openvdb::Coord(0, 5, 35), false);
  const SliceFrame frame = sliceFrame({grid}, 2);
  const auto values = sliceGrid(*grid, frame, 35)[0].values;
  const auto mask = sliceMask({grid}, frame, 35);
  const std::size_t hole = (9 - 5) * frame.columns() + 5;
  EXPECT_EQ(values[hole], 0);
  EXPECT_EQ(mask[hole], 0);
  EXPECT_EQ(values[hole + 1], 3);
  EXPECT_EQ(mask[hole + 1], 1);

  const auto surface = ball(9.5, openvdb::Vec3d(0, 0, 0), 1);
  const SliceFrame around = sliceFrame({surface}, 2);
  const auto distance = sliceGrid(*surface, around, 0)[0].values;
  EXPECT_EQ(distance[around.rows() / 2 * around.columns() + around.columns() / 2], -3);
  EXPECT_EQ(distance[0], 3);
}

TEST(Slice, VectorsHaveThreeChannels) {
  const auto make = [](const std::string& name) {
    return block<openvdb::Vec3SGrid>(name, kBox,
                                     [](auto c) { return openvdb::Vec3f(c.x(), c.y(), c.z()); });
  };
  EXPECT_EQ(channelNames(*make("map")), (std::vector<std::string>{"map.X", "map.Y", "map.Z"}));
  EXPECT_EQ(channelNames(*make("Cd")), (std::vector<std::string>{"Cd.R", "Cd.G", "Cd.B"}));
  const auto grid = make("map");
  const SliceFrame frame = sliceFrame({grid}, 1);
  const auto channels = sliceGrid(*grid, frame, 4);
  EXPECT_EQ(channels[1].values, std::vector<float>(frame.rows() * frame.columns(), 4.0f));
  EXPECT_EQ(channels[0].values[3], -2);
  EXPECT_EQ(channels[2].values[0], 41);
}

TEST(Slice, PositionsGoBothWays) {
  const auto grid = coded();
  for (int axis = 0; axis < 3; ++axis) {
    const SliceFrame frame = sliceFrame({grid}, axis);
    EXPECT_DOUBLE_EQ(frame.position(7.25), 3.625);
    EXPECT_NEAR(frame.layerAt(frame.position(7.25)), 7.25, 1e-12);
  }
}

TEST(Slice, RefusesWhatCannotBeSliced) {
  EXPECT_THROW(sliceFrame({}, 2), DataError);
  const auto grid = coded();
  const auto other = grid->deepCopy();
  other->transform().preScale(2.0);
  EXPECT_THROW(sliceFrame({grid, other}, 2), DataError);
  EXPECT_THROW(sliceFrame({openvdb::FloatGrid::create()}, 2), DataError);
  const auto huge = grid->deepCopy();
  huge->tree().setValue(openvdb::Coord(2000000000, 0, 0), 1.0f);
  huge->tree().setValue(openvdb::Coord(-2000000000, 0, 0), 1.0f);
  EXPECT_THROW(sliceFrame({huge}, 2), DataError);
  EXPECT_THROW(parseAxis("--axis", "w"), SettingError);
  EXPECT_THROW(parseAxis("--axis", ""), SettingError);
  EXPECT_EQ(parseAxis("--axis", "Y"), 1);
}

TEST(Section, IsCutWhereMostOfTheSolidIs) {
  EXPECT_EQ(thinnestAxis({3, 1, 2}), 1);
  EXPECT_EQ(thinnestAxis({1, 1, 1}), 0);
  auto density = openvdb::FloatGrid::create();
  density->fill({{0, 0, 0}, {9, 9, 9}}, 0.1f);
  density->fill({{0, 0, 2}, {9, 9, 2}}, 1.0f);
  EXPECT_DOUBLE_EQ(fullLayer(*density, 2), 0.25);
  density->fill({{0, 0, 6}, {9, 9, 6}}, 0.95f);  // nearly as much, and nearer the middle
  EXPECT_DOUBLE_EQ(fullLayer(*density, 2), 0.65);
}

}  // namespace
}  // namespace innermap
