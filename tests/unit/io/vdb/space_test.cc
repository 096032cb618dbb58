// Grids in other axes and units.
#include <gtest/gtest.h>

#include <random>

#include "innermap/core/error.h"
#include "innermap/io/vdb_file.h"
#include "io/test_files.h"

namespace innermap {
namespace {

using openvdb::Coord;

SpaceSettings settings(UpAxis up, double unit, UpAxis outUp, double outUnit) {
  return {.up = up, .unitScale = unit, .outUp = outUp, .outUnitScale = outUnit};
}

openvdb::math::Transform::Ptr place() {
  openvdb::Mat4d matrix = openvdb::Mat4d::identity();
  matrix.setRow(0, openvdb::Vec4d(0, 0.5, 0, 0));
  matrix.setRow(1, openvdb::Vec4d(-0.25, 0, 0, 0));
  matrix.setRow(2, openvdb::Vec4d(0, 0.1, 2, 0));
  matrix.setRow(3, openvdb::Vec4d(10, -20, 30, 1));
  return openvdb::math::Transform::createLinearTransform(matrix);
}

// Scattered voxels and a tile; values and states stay at their places in the world.
TEST(Space, VoxelsAndTilesStayAtTheirPlaces) {
  openvdb::initialize();
  std::mt19937 random(11);
  auto grid = openvdb::FloatGrid::create(0.5f);
  grid->setTransform(place());
  grid->setName("density");
  for (int i = 0; i < 500; ++i) {
    const Coord at(int(random() % 400) - 200, int(random() % 40) - 20, int(random() % 90) - 70);
    grid->tree().setValue(at, float(i));
    if (i % 3 == 0) grid->tree().setValueOff(at, float(i));
  }
  grid->tree().fill({Coord(0, 128, -256), Coord(127, 255, -129)}, 7, true);
  for (const auto& space :
       {settings(UpAxis::y, 0.01, UpAxis::z, 1), settings(UpAxis::z, 1, UpAxis::y, 2),
        settings(UpAxis::y, 3, UpAxis::y, 1)}) {
    const Similarity by = inputToOutput(space);
    openvdb::GridPtrVec grids{grid};
    moveGrids(grids, by);
    const auto out = openvdb::gridPtrCast<openvdb::FloatGrid>(grids.front());
    ASSERT_TRUE(out);
    EXPECT_EQ(out->getName(), "density");
    EXPECT_EQ(out->activeVoxelCount(), grid->activeVoxelCount());
    EXPECT_EQ(out->tree().activeTileCount(), grid->tree().activeTileCount());
    EXPECT_EQ(out->tree().leafCount(), grid->tree().leafCount());
    const auto accessor = out->getConstAccessor();
    for (auto value = grid->cbeginValueAll(); value; ++value) {
      if (!value.isVoxelValue()) continue;
      const openvdb::Vec3d p = grid->indexToWorld(value.getCoord());
      const Vec3 q = by({p.x(), p.y(), p.z()});
      const Coord there = Coord::round(out->worldToIndex(openvdb::Vec3d(q.x, q.y, q.z)));
      ASSERT_LT((out->indexToWorld(there) - openvdb::Vec3d(q.x, q.y, q.z)).length(), 1e-9);
      ASSERT_EQ(accessor.getValue(there), *value);
      ASSERT_EQ(accessor.isValueOn(there), value.isValueOn());
    }
    moveGrids(grids, inputToOutput(settings(space.upOfOutput(), space.unitOfOutput(), *space.up,
                                            *space.unitScale)));
    const auto back = openvdb::gridPtrCast<openvdb::FloatGrid>(grids.front());
    EXPECT_TRUE(back->tree().hasSameTopology(grid->tree()) || by.quarters != 0);
    EXPECT_EQ(back->activeVoxelCount(), grid->activeVoxelCount());
  }
}

TEST(Space, ValuesMoveByWhatTheyAre) {
  openvdb::initialize();
  const Similarity by = inputToOutput(settings(UpAxis::y, 2, UpAxis::z, 1));
  const openvdb::Vec3s v(1, 2, 3);
  const std::pair<openvdb::VecType, openvdb::Vec3s> kinds[] = {
      {openvdb::VEC_INVARIANT, {1, 2, 3}},
      {openvdb::VEC_CONTRAVARIANT_RELATIVE, {2, -6, 4}},
      {openvdb::VEC_CONTRAVARIANT_ABSOLUTE, {2, -6, 4}},
      {openvdb::VEC_COVARIANT, {0.5f, -1.5f, 1}}};
  for (const auto& [kind, wanted] : kinds) {
    auto grid = openvdb::Vec3SGrid::create();
    grid->setVectorType(kind);
    grid->tree().setValue(Coord(1, 2, 3), v);
    openvdb::GridPtrVec grids{grid};
    moveGrids(grids, by);
    const auto& out = static_cast<const openvdb::Vec3SGrid&>(*grids.front());
    EXPECT_LT((*out.cbeginValueOn() - wanted).length(), 1e-6) << int(kind);
    EXPECT_EQ(out.getVectorType(), kind);
  }
  auto distances = openvdb::FloatGrid::create(3);
  distances->setGridClass(openvdb::GRID_LEVEL_SET);
  distances->tree().setValue(Coord(1, 2, 3), -1.5f);
  openvdb::GridPtrVec grids{distances};
  moveGrids(grids, by);
  const auto& out = static_cast<const openvdb::FloatGrid&>(*grids.front());
  EXPECT_FLOAT_EQ(out.background(), 6);
  EXPECT_FLOAT_EQ(*out.cbeginValueOn(), -3);
  sayInGrids(grids, settings(UpAxis::y, 2, UpAxis::z, 1));
  EXPECT_EQ(out.metaValue<std::string>("innermap_up"), "z");
  EXPECT_EQ(out.metaValue<double>("innermap_metres_per_unit"), 1);
}

TEST(Space, RefusesWhatCannotBeTurned) {
  openvdb::initialize();
  auto grid = openvdb::Vec3SGrid::create();
  grid->setGridClass(openvdb::GRID_STAGGERED);
  openvdb::GridPtrVec grids{grid};
  EXPECT_THROW(moveGrids(grids, inputToOutput(settings(UpAxis::y, 1, UpAxis::z, 1))), DataError);
  EXPECT_NO_THROW(moveGrids(grids, inputToOutput(settings(UpAxis::y, 2, UpAxis::y, 1))));
  EXPECT_THROW(inputToOutput(settings(UpAxis::y, -1, UpAxis::y, 1)), SettingError);
}

}  // namespace
}  // namespace innermap
