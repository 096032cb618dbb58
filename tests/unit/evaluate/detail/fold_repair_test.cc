#include "evaluate/detail/fold_repair.h"

#include <gtest/gtest.h>

#include "evaluate/test_lattice.h"
#include "innermap/core/run.h"

namespace innermap {
namespace {

using openvdb::Coord;

Vec3 stay(const Vec3& p) { return p; }

openvdb::FloatGrid::Ptr ones(const test::Lattice& lattice) {
  const auto grid = openvdb::FloatGrid::create(0);
  for (auto voxel = lattice.map->cbeginValueOn(); voxel; ++voxel)
    grid->tree().setValue(voxel.getCoord(), 1);
  return grid;
}

void apply(const FoldRepair& repair, test::Lattice& lattice) {
  for (const auto& [at, voxel] : repair.voxels)
    lattice.map->tree().setValue(
        at, openvdb::Vec3f(openvdb::Vec3d(voxel.position.x, voxel.position.y, voxel.position.z)));
}

TEST(FoldRepair, CellsAreTurnedRightWhereNoVoxelIsFolded) {
  test::Lattice lattice;
  lattice.addBox(Coord(0), Coord(15), stay);
  lattice.map->tree().setValue(Coord(8), {9.7f, 8.2f, 8.1f});  // beyond its neighbour
  ASSERT_GT(lattice.check().folded, 0u);
  const FoldRepair repair = repairFolds(*lattice.map, *ones(lattice), *lattice.levelSet, {});
  EXPECT_EQ(repair.voxels.count(Coord(8)), 1u);
  EXPECT_GT(repair.farthest, 0.5);
  for (const auto& [at, voxel] : repair.voxels) {
    EXPECT_GT(determinant(voxel.jacobian), 0);
    // The other way is as far as two voxels, from the corners of the cells that were folded.
    for (int k = 0; k < 3; ++k) EXPECT_LE(std::abs(at[k] - 8), 3) << at;
  }
  apply(repair, lattice);
  EXPECT_EQ(lattice.check().folded, 0u);
}

// Reflected in x = 0, floats are as exact.
TEST(FoldRepair, AMirroredMapIsRepairedAsItsReflection) {
  test::Lattice lattice, mirrored;
  lattice.addBox(Coord(0), Coord(15), stay);
  mirrored.addBox(Coord(0), Coord(15), [](const Vec3& p) { return Vec3{-p.x, p.y, p.z}; });
  lattice.map->tree().setValue(Coord(8), {9.7f, 8.2f, 8.1f});
  mirrored.map->tree().setValue(Coord(8), {-9.7f, 8.2f, 8.1f});
  const auto minus = ones(mirrored);
  for (auto voxel = minus->beginValueOn(); voxel; ++voxel) voxel.setValue(-1);
  const FoldRepair repair = repairFolds(*lattice.map, *ones(lattice), *lattice.levelSet, {}),
                   other =
                       repairFolds(*mirrored.map, *minus, *mirrored.levelSet, {.mirrored = true});
  ASSERT_FALSE(repair.voxels.empty());
  ASSERT_EQ(other.voxels.size(), repair.voxels.size());
  EXPECT_DOUBLE_EQ(other.farthest, repair.farthest);
  for (const auto& [at, voxel] : repair.voxels) {
    const RepairedVoxel& twin = other.voxels.at(at);
    EXPECT_NEAR(twin.position.x, -voxel.position.x, 1e-12);
    EXPECT_NEAR(twin.position.y, voxel.position.y, 1e-12);
    EXPECT_NEAR(determinant(twin.jacobian), -determinant(voxel.jacobian), 1e-12);
  }
}

// A map that flattens the solid to a twentieth: evening that out would push its skin far out.
TEST(FoldRepair, WhatTheMapStretchesStaysStretched) {
  constexpr float kFlat = 0.05f;
  test::Lattice lattice;
  lattice.addBox(Coord(0), Coord(15), [](const Vec3& p) {
    return Vec3{p.x, p.y, static_cast<double>(kFlat) * p.z};
  });
  lattice.map->tree().setValue(Coord(8, 8, 13), {8, 8, 15.5f * kFlat});  // beyond its neighbours
  ASSERT_GT(lattice.check().folded, 0u);
  const FoldRepair repair = repairFolds(*lattice.map, *ones(lattice), *lattice.levelSet, {});
  apply(repair, lattice);
  EXPECT_EQ(lattice.check().folded, 0u);
  for (const auto& [at, voxel] : repair.voxels) {
    EXPECT_LT(voxel.position.z, static_cast<double>(18 * kFlat)) << at;
    if (at == Coord(8, 8, 13)) continue;
    EXPECT_LT(norm(voxel.position - Vec3{1.0 * at.x(), 1.0 * at.y(), kFlat * at.z()}), 0.2) << at;
  }
}

TEST(FoldRepair, SaysHowFarItIs) {
  struct Recorder : RunContext {
    void report(std::string_view stage, double fraction) override {
      EXPECT_EQ(stage, kRepairing);
      EXPECT_GE(fraction, last);
      EXPECT_LE(fraction, 1);
      last = fraction;
      ++reports;
    }
    double last = 0;
    int reports = 0;
  } run;
  test::Lattice lattice;
  lattice.addBox(Coord(0), Coord(40, 10, 10), stay);
  for (const int x : {5, 35}) {
    const auto at = static_cast<float>(x);
    lattice.map->tree().setValue(Coord(x, 5, 5), {at + 1.7f, 5.2f, 5.1f});
  }
  const RunScope scope(run);
  const auto jacobian = ones(lattice);
  repairFolds(*lattice.map, *jacobian, *lattice.levelSet, {});
  EXPECT_GE(run.reports, 2);
  EXPECT_GT(run.last, 0);
  run.cancel();
  EXPECT_THROW(repairFolds(*lattice.map, *jacobian, *lattice.levelSet, {}), Cancelled);
}

TEST(FoldRepair, NothingIsDoneWhereNothingIsFolded) {
  test::Lattice lattice;
  lattice.addBox(Coord(0), Coord(9), stay);
  const FoldRepair repair = repairFolds(*lattice.map, *ones(lattice), *lattice.levelSet, {});
  EXPECT_TRUE(repair.voxels.empty());
  EXPECT_EQ(repair.farthest, 0);
}

// A rod one voxel thick has no cells.
TEST(FoldRepair, AVoxelWithoutCellsFollowsThoseAboutIt) {
  test::Lattice lattice;
  lattice.addBox(Coord(0), Coord(9), stay);
  lattice.addBox({10, 4, 4}, {11, 4, 4}, stay);
  const auto jacobian = ones(lattice);
  jacobian->tree().setValue(Coord(10, 4, 4), -1);
  lattice.map->tree().setValue(Coord(10, 4, 4), {8.5f, 4, 4});
  const FoldRepair repair = repairFolds(*lattice.map, *jacobian, *lattice.levelSet, {});
  const auto found = repair.voxels.find(Coord(10, 4, 4));
  ASSERT_NE(found, repair.voxels.end());
  EXPECT_LT(norm(found->second.position - Vec3{10, 4, 4}), 0.6);  // on its side of 9, by far
  EXPECT_GT(determinant(found->second.jacobian), 0.5);
}

TEST(FoldRepair, TooManyTogetherAreLeft) {
  test::Lattice lattice;
  lattice.addBox(Coord(0), Coord(23), [](const Vec3& p) { return Vec3{-p.x, p.y, p.z}; });
  const FoldRepair repair = repairFolds(*lattice.map, *ones(lattice), *lattice.levelSet, {});
  EXPECT_TRUE(repair.voxels.empty());
}

}  // namespace
}  // namespace innermap
