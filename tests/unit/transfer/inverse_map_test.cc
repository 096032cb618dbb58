#include "innermap/transfer/inverse_map.h"

#include <gtest/gtest.h>

#include "core/expect.h"
#include "evaluate/active_region.h"
#include "innermap/core/error.h"
#include "transfer/test_maps.h"

namespace innermap {
namespace {

using namespace test;

SourceLattice latticeOf(const Solid& solid, int resolution) {
  SourceLattice out{.levelSet = levelSetOf(solid, resolution)};
  out.region = activeRegion(*out.levelSet);
  return out;
}

// Calls visit(q, index) for the voxels of an inverted map in their order.
template <class Visit>
void forVoxels(const InvertedMap& inverted, const Visit& visit) {
  std::size_t i = 0;
  for (auto leaf = inverted.region->tree().cbeginLeaf(); leaf; ++leaf)
    for (auto voxel = leaf->cbeginValueOn(); voxel; ++voxel, ++i)
      visit(voxel.getCoord(), toVec3(inverted.region->transform().indexToWorld(voxel.getCoord())),
            i);
  EXPECT_EQ(i, inverted.sources.size());
}

InvertedMap invert(const HarmonicMap& map, const Mesh& mesh, int resolution,
                   const InverseSettings& settings = {}) {
  const Solid source(mesh), target(moved(mesh, map));
  return invertMap(map, source, latticeOf(source, 32), *levelSetOf(target, resolution), settings);
}

TEST(InverseMap, BringsEachVoxelBack) {
  const HarmonicMap map = chargedMap();
  const InvertedMap inverted = invert(map, ball(), 48);
  const InverseStatistics& s = inverted.statistics;
  EXPECT_EQ(s.voxels, inverted.sources.size());
  EXPECT_GT(s.voxels, 50000u);
  EXPECT_EQ(s.failed, 0u);
  EXPECT_EQ(s.inverted, s.voxels);
  EXPECT_LE(s.largestResidual, 1e-3);
  const double voxel = inverted.region->voxelSize()[0];
  double error = 0, slope = 0;
  forVoxels(inverted, [&](const openvdb::Coord&, const Vec3& q, std::size_t i) {
    const Vec3 p = inverted.sources[i];
    if (norm(p) > 0.98) return;  // outside the map is extended
    error = std::max(error, norm(map(p) - q));
    const Mat3 j = map.jacobian(p);
    for (int k = 0; k < 9; ++k)
      slope = std::max(slope, std::abs(inverted.jacobians[i][k] - j[k / 3][k % 3]));
  });
  EXPECT_LE(error, 1.1e-3 * voxel);
  EXPECT_LE(slope, 1e-5);
}

TEST(InverseMapRelease, AffineMapsAreInvertedToRounding) {
  const CounterRandom random(20261121, 0);
  for (int trial = 0; trial < 5; ++trial) {
    Mat3 m;
    Vec3 shift;
    for (int k = 0; k < 9; ++k)
      m[k / 3][k % 3] = (k % 4 == 0) + 0.8 * (random.uniform(20 * trial + k) - 0.5);
    for (int a = 0; a < 3; ++a) shift[a] = 1000 * random.uniform(20 * trial + 9 + a);
    const InvertedMap inverted = invert(affineMap(m, shift), ball(), 24);
    EXPECT_EQ(inverted.statistics.failed, 0u) << "trial " << trial;
    const Mat3 back = inverse(m);
    double error = 0;
    forVoxels(inverted, [&](const openvdb::Coord&, const Vec3& q, std::size_t i) {
      error = std::max(error, norm(inverted.sources[i] - back * (q - shift)));
    });
    EXPECT_LT(error, 1e-9) << "trial " << trial;
  }
}

TEST(InverseMap, MirrorsAreMapsToo) {
  const InvertedMap inverted =
      invert(affineMap({{{-1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}, {}), ball(), 24);
  EXPECT_EQ(inverted.statistics.failed, 0u);
  forVoxels(inverted, [&](const openvdb::Coord&, const Vec3& q, std::size_t i) {
    ASSERT_NEAR(inverted.sources[i].x, -q.x, 1e-9);
  });
}

// Charges so strong that the map folds: what cannot be inverted is told and filled.
TEST(InverseMap, FoldsAreCountedAndFilled) {
  const HarmonicMap map = chargedMap(4);
  std::size_t folded = 0;
  for (const Vec3& v : ball(0.99).vertices) folded += determinant(map.jacobian(v)) < 0;
  ASSERT_GT(folded, 0u);
  const InvertedMap inverted = invert(map, ball(), 48);
  const InverseStatistics& s = inverted.statistics;
  EXPECT_EQ(s.inverted + s.failed, s.voxels);
  EXPECT_EQ(s.failedInside > 0, !s.failedAt.empty());
  EXPECT_LE(s.failedInside, s.failed);
  EXPECT_GT(s.inverted, s.voxels / 2);
  for (const Vec3& p : inverted.sources) ASSERT_TRUE(isFinite(p));
}

// Half of the lattice cut away: from its edge Newton's steps do not reach the far end, but from the
// neighbours that they did reach they do.
TEST(InverseMapRelease, WhatIsNotInvertedStartsAgainFromItsNeighbours) {
  const HarmonicMap map = chargedMap();
  const Solid source(ball()), target(moved(ball(), map));
  SourceLattice half = latticeOf(source, 128);
  for (auto leaf = half.region->tree().beginLeaf(); leaf; ++leaf)
    for (auto voxel = leaf->beginValueOn(); voxel; ++voxel)
      if (half.region->indexToWorld(voxel.getCoord()).x() > -0.2) leaf->setValueOff(voxel.pos());
  const InvertedMap inverted = invertMap(map, source, half, *levelSetOf(target, 32));
  EXPECT_GT(inverted.statistics.uncovered, inverted.statistics.voxels / 2);
  EXPECT_EQ(inverted.statistics.failedInside, 0u);
}

// A hole in the cover: voxels whose source is cut out of the lattice have their neighbours' source.
TEST(InverseMap, VoxelsFromNowhereHaveTheirNeighboursSource) {
  const Solid source(ball());
  const HarmonicMap map = affineMap({{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}, {});
  // The target given is twice as large as the map's: beyond the skin nothing comes from anywhere.
  const Solid target(ball(1.5));
  const InvertedMap inverted =
      invertMap(map, source, latticeOf(source, 32), *levelSetOf(target, 32), {});
  EXPECT_GT(inverted.statistics.uncovered, 0u);
  forVoxels(inverted, [&](const openvdb::Coord&, const Vec3& q, std::size_t i) {
    ASSERT_LT(norm(inverted.sources[i] - q), 0.2);
  });
}

TEST(InverseMapRelease, OutsideEndsAtTheDistanceOrGoesOn) {
  const Solid source(ball());
  const HarmonicMap map = affineMap({{{1.2, 0, 0}, {0, 1.2, 0}, {0, 0, 1.2}}}, {});
  const Solid target(ball(1.2));
  SourceLattice lattice = latticeOf(source, 32);
  lattice.region->tree().fill(openvdb::CoordBBox(openvdb::Coord(-20), openvdb::Coord(60)), true);
  lattice.region->tree().voxelizeActiveTiles();
  InverseSettings settings;
  settings.outside.distance = 0.1;
  const double reach = 0.1 * source.diagonal();
  const InvertedMap cut = invertMap(map, source, lattice, *levelSetOf(target, 32), settings);
  double farthest = 0;
  for (const Vec3& p : cut.sources) farthest = std::max(farthest, norm(p));
  EXPECT_NEAR(farthest, 1 + reach, 0.1);
  settings.outside.fadeTo = RigidMotion();
  const InvertedMap faded = invertMap(map, source, lattice, *levelSetOf(target, 32), settings);
  std::size_t beyond = 0;
  forVoxels(faded, [&](const openvdb::Coord&, const Vec3& q, std::size_t i) {
    if (norm(q) < 1.2 + 2 * reach) return;
    ++beyond;
    ASSERT_LT(norm(faded.sources[i] - q), 1e-3);
  });
  EXPECT_GT(beyond, 1000u);
}

TEST(InverseMap, InvertsPointsBetweenVoxels) {
  const HarmonicMap map = chargedMap();
  const Solid source(ball()), target(moved(ball(), map));
  const SourceLattice lattice = latticeOf(source, 32);
  const InvertedMap inverted = invertMap(map, source, lattice, *levelSetOf(target, 32));
  const CounterRandom random(7, 0);
  Points inside, images;
  for (int i = 0; i < 200; ++i) {
    const Vec3 p{random.uniform(3 * i) - 0.5, random.uniform(3 * i + 1) - 0.5,
                 random.uniform(3 * i + 2) - 0.5};
    inside.push_back(p);
    images.push_back(map(p));
  }
  images.push_back({50, 0, 0});
  const Points found = invertAt(map, source, lattice, inverted, images);
  const double voxel = inverted.region->voxelSize()[0];
  for (std::size_t i = 0; i < inside.size(); ++i)
    EXPECT_LT(norm(map(found[i]) - images[i]), 1.1e-3 * voxel);
  EXPECT_NEAR(found.back().x, 50, 1e-12);  // nowhere: left as it is
}

TEST(InverseMap, RefusesBadSettingsAndObeysCancel) {
  InverseSettings settings{.tolerance = 0};
  EXPECT_THROW(invert(chargedMap(), ball(), 16, settings), SettingError);
  settings = {};
  settings.outside.distance = -1;
  EXPECT_THROW(invert(chargedMap(), ball(), 16, settings), SettingError);
  settings = {};
  test::expectCancels([&] { invert(chargedMap(), ball(), 16, settings); });
  settings = {};
  test::expectOverLimit(1000, [&] { invert(chargedMap(), ball(), 16, settings); });
}

TEST(InverseStatistics, SaysSharesAndWarnsOfMany) {
  InverseStatistics s;
  EXPECT_EQ(s.invertedInside(), 1);
  s.voxels = 300;
  s.inside = 200;
  s.failed = 51;
  s.failedInside = 1;
  s.failedAt = {{1, 2, 3}};
  EXPECT_DOUBLE_EQ(s.invertedInside(), 0.995);
  EXPECT_DOUBLE_EQ(s.invertedOutside(), 0.5);
  s.failedInside = 4;
  EXPECT_NE(s.warning().find("2%"), std::string::npos) << s.warning();
  EXPECT_NE(s.warning().find("(1, 2, 3)"), std::string::npos) << s.warning();
  s.inside = 10000;
  EXPECT_EQ(s.warning(), "");
}

}  // namespace
}  // namespace innermap
