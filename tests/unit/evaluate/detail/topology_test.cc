#include "evaluate/topology.h"

#include <gtest/gtest.h>

namespace innermap {
namespace {

openvdb::MaskGrid::Ptr region() {
  auto out = openvdb::MaskGrid::create();
  out->setTransform(openvdb::math::Transform::createLinearTransform(0.25));
  for (int i = -40; i < 40; ++i) out->tree().setValueOn({i, 3 * i, -i * i});
  return out;
}

template <class Grid>
void expectOnRegion(typename Grid::ValueType background) {
  auto like = Grid::create(background);
  like->setName("name");
  like->setGridClass(openvdb::GRID_FOG_VOLUME);
  like->insertMeta("note", openvdb::StringMetadata("kept"));
  const auto on = region();
  const auto made = openvdb::gridPtrCast<Grid>(emptyLike(*like, *on));
  ASSERT_TRUE(made);
  EXPECT_EQ(made->getName(), "name");
  EXPECT_EQ(made->getGridClass(), openvdb::GRID_FOG_VOLUME);
  EXPECT_EQ(made->template metaValue<std::string>("note"), "kept");
  EXPECT_EQ(made->transform(), on->transform());
  EXPECT_TRUE(made->tree().hasSameTopology(on->tree()));
  EXPECT_EQ(made->activeVoxelCount(), on->activeVoxelCount());
  EXPECT_EQ(made->tree().getValue({0, 0, 0}), background);
  EXPECT_TRUE(activeTopology(*made).hasSameTopology(on->tree())) << made->type();
}

TEST(Topology, IsCopiedToEveryType) {
  openvdb::initialize();
  expectOnRegion<openvdb::FloatGrid>(2.5f);
  expectOnRegion<openvdb::DoubleGrid>(-1);
  expectOnRegion<openvdb::Int32Grid>(7);
  expectOnRegion<openvdb::Int64Grid>(8);
  expectOnRegion<openvdb::Vec3SGrid>({1, 2, 3});
  expectOnRegion<openvdb::Vec3DGrid>({1, 2, 3});
  expectOnRegion<openvdb::Vec3IGrid>({1, 2, 3});
  const auto on = region();
  EXPECT_TRUE(activeTopology(*emptyLike(*openvdb::BoolGrid::create(false), *on))
                  .hasSameTopology(on->tree()));
  EXPECT_TRUE(
      activeTopology(*emptyLike(*openvdb::MaskGrid::create(), *on)).hasSameTopology(on->tree()));
  EXPECT_EQ(floatGridOn(*on)->activeVoxelCount(), on->activeVoxelCount());
  EXPECT_EQ(vectorGridOn(*on)->transform(), on->transform());
}

TEST(Topology, HasTilesOfAllSizes) {
  auto grid = openvdb::FloatGrid::create();
  grid->tree().addTile(1, {8, 8, 8}, 1, true);
  grid->tree().addTile(2, {1024, 0, 0}, 1, true);
  grid->tree().addTile(3, {-4096, 0, 0}, 1, true);
  grid->tree().addTile(1, {64, 8, 8}, 1, false);
  grid->tree().setValueOn({0, 0, 0}, 1);
  const openvdb::MaskTree mask = activeTopology(*grid);
  EXPECT_EQ(mask.activeTileCount(), 3u);
  EXPECT_EQ(mask.activeVoxelCount(), grid->activeVoxelCount());
  openvdb::MaskGrid region;
  region.setTree(std::make_shared<openvdb::MaskTree>(mask));
  EXPECT_EQ(floatGridOn(region)->activeVoxelCount(), grid->activeVoxelCount());
}

}  // namespace
}  // namespace innermap
