#include <gtest/gtest.h>
#include <openvdb/tools/LevelSetSphere.h>

#include "innermap/core/error.h"
#include "innermap/levelset/level_set.h"
#include "innermap/transfer/inverse_map.h"
#include "innermap/transfer/push_pull.h"
#include "transfer/test_maps.h"

namespace innermap {
namespace {

const Mat3 kLinear{{{1.2, 0.3, 0}, {0, 0.9, 0.1}, {-0.2, 0, 1.1}}};
const Vec3 kShift{0.5, -0.25, 0.1};

// That affine map, point by point.
SolidMap pointwise() {
  const Mat3 back = inverse(kLinear);
  return SolidMap::Pointwise{[](const Vec3& p) {
                               return PointImage{kLinear * p + kShift, kLinear};
                             },
                             [back](const Vec3& q) {
                               return PointImage{back * (q - kShift), back};
                             },
                             4, 4};
}

Mesh ballMesh(bool moved) {
  Mesh mesh = shapes::icosphere(3);
  if (moved)
    for (Vec3& p : mesh.vertices) p = kLinear * p + kShift;
  return mesh;
}

openvdb::FloatGrid::Ptr levelSetOf(const Mesh& mesh) {
  return makeLevelSet(Solid(mesh), {.resolution = 24});
}

openvdb::Vec3fGrid::Ptr flow(const openvdb::FloatGrid& like) {
  auto grid = openvdb::Vec3fGrid::create();
  grid->setName("flow");
  grid->setTransform(like.transform().copy());
  grid->setVectorType(openvdb::VEC_CONTRAVARIANT_RELATIVE);
  auto access = grid->getAccessor();
  for (auto v = like.cbeginValueOn(); v; ++v) {
    const openvdb::Vec3d p = like.indexToWorld(v.getCoord());
    access.setValue(v.getCoord(), openvdb::Vec3f(openvdb::Vec3d(p.y(), 1, p.x() - p.z())));
  }
  for (auto v = like.cbeginValueOff(); v; ++v)
    if (v.isVoxelValue() && *v < 0) {
      const openvdb::Vec3d p = like.indexToWorld(v.getCoord());
      access.setValue(v.getCoord(), openvdb::Vec3f(openvdb::Vec3d(p.y(), 1, p.x() - p.z())));
    }
  return grid;
}

double largestDifference(const openvdb::GridBase& a, const openvdb::GridBase& b) {
  const auto& x = dynamic_cast<const openvdb::Vec3fGrid&>(a);
  const auto& y = dynamic_cast<const openvdb::Vec3fGrid&>(b);
  EXPECT_EQ(x.activeVoxelCount(), y.activeVoxelCount());
  EXPECT_GT(x.activeVoxelCount(), 1000u);
  double most = 0;
  auto other = y.getConstAccessor();
  for (auto v = x.cbeginValueOn(); v; ++v)
    most = std::max(most, double((*v - other.getValue(v.getCoord())).length()));
  return most;
}

// The same affine map either way.
TEST(SolidMap, PointwiseOnesPushAndPullAsHarmonicOnesDo) {
  const Solid source(ballMesh(false));
  const HarmonicMap map = test::affineMap(kLinear, kShift);
  const auto here = levelSetOf(ballMesh(false)), there = levelSetOf(ballMesh(true));
  const auto pushed = [&](const SolidMap& way) {
    return VolumePusher(source, {flow(*here)}).push(way, *there);
  };
  const auto pulled = [&](const SolidMap& way) {
    return pullGrids(way, source, *here, {flow(*there)}, {.targetLevelSet = there.get()});
  };
  EXPECT_LT(largestDifference(*pushed(map).grids[0], *pushed(pointwise()).grids[0]), 1e-3);
  const PullResult back = pulled(map), same = pulled(pointwise());
  EXPECT_LT(largestDifference(*back.grids[0], *same.grids[0]), 1e-3);
  EXPECT_NEAR(same.resampling.largestGrowth, back.resampling.largestGrowth, 1e-6);
}

TEST(SolidMap, PointwiseOnesKeepTheMassOfDensities) {
  const Solid source(ballMesh(false));
  const auto there = levelSetOf(ballMesh(true));
  auto density = openvdb::FloatGrid::create();
  density->setName("density");
  density->setTransform(levelSetOf(ballMesh(false))->transform().copy());
  const openvdb::Coord centre =
      density->transform().worldToIndexNodeCentered(openvdb::Vec3d(0, 0, 0));
  density->fill(openvdb::CoordBBox(centre.offsetBy(-3), centre.offsetBy(3)), 1.0F);
  PushSettings push;
  push.carry.allDensities = true;
  const PushResult made = VolumePusher(source, {density}, push).push(pointwise(), *there);
  ASSERT_EQ(made.masses.size(), 1u);
  EXPECT_GT(made.masses[0].before, 0);
  EXPECT_NEAR(made.masses[0].after / made.masses[0].before, 1, 1e-6);
}

}  // namespace
}  // namespace innermap
