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

ThroughMap affineThrough() {
  const Mat3 back = inverse(kLinear);
  return {[](const Points& at, Points& images, std::vector<Mat3>& jacobians) {
            for (const Vec3& p : at) {
              images.push_back(kLinear * p + kShift);
              jacobians.push_back(kLinear);
            }
          },
          [back](const Points& at, Points& images, std::vector<Mat3>& jacobians) {
            for (const Vec3& p : at) {
              images.push_back(back * (p - kShift));
              jacobians.push_back(back);
            }
          }};
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
TEST(ThroughMap, PushAndPullAgreeWithTheMapItself) {
  const Solid source(ballMesh(false));
  const ThroughMap through = affineThrough();
  const HarmonicMap map = test::affineMap(kLinear, kShift);
  const auto here = levelSetOf(ballMesh(false)), there = levelSetOf(ballMesh(true));
  PushSettings push;
  const openvdb::GridPtrVec given{flow(*here)};
  const auto plain = VolumePusher(source, given, push).push(map, *there).grids;
  push.through = &through;
  EXPECT_LT(
      largestDifference(*plain[0], *VolumePusher(source, given, push).push(map, *there).grids[0]),
      1e-3);
  const openvdb::GridPtrVec posed{flow(*there)};
  const auto back = pullGrids(map, source, *here, posed, {.targetLevelSet = there.get()}).grids;
  EXPECT_LT(
      largestDifference(*back[0], *pullGrids(map, source, *here, posed,
                                             {.targetLevelSet = there.get(), .through = &through})
                                       .grids[0]),
      1e-3);
}

TEST(ThroughMap, DensitiesAreRefused) {
  const Solid source(ballMesh(false));
  const ThroughMap through = affineThrough();
  auto density = openvdb::FloatGrid::create();
  density->setName("density");
  density->setTransform(levelSetOf(ballMesh(false))->transform().copy());
  density->fill(openvdb::CoordBBox(openvdb::Coord(-3), openvdb::Coord(3)), 1.0F);
  PushSettings push{.through = &through};
  push.carry.allDensities = true;
  EXPECT_THROW(VolumePusher(source, {density}, push), DataError);
}

}  // namespace
}  // namespace innermap
