#include "innermap/transfer/distance_transfer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "field/affine_map.h"
#include "innermap/core/error.h"
#include "innermap/levelset/level_set.h"
#include "mesh/shapes.h"

namespace innermap {
namespace {

using test::affineMap;

const Vec3 kLower{-1, -0.6, -0.8}, kUpper{1.1, 0.7, 0.9};

double boxDepth(const openvdb::Vec3d& p) {
  double depth = 1e9, outside = 0;
  for (int a = 0; a < 3; ++a) {
    const double d = std::min(p[a] - kLower[a], kUpper[a] - p[a]);
    depth = std::min(depth, d);
    if (d < 0) outside += d * d;
  }
  return outside > 0 ? -std::sqrt(outside) : depth;
}

openvdb::FloatGrid::Ptr levelSet(const Solid& solid) {
  return makeLevelSet(solid, {.resolution = 40});
}

TEST(DistanceTransfer, DepthIsExactEverywhereInside) {
  const Solid solid(shapes::box(kLower, kUpper));
  const auto surface = levelSet(solid);
  const auto depth = depthInside(solid, *surface);
  EXPECT_EQ(depth->getName(), "distance");
  EXPECT_EQ(depth->constTransform(), surface->constTransform());
  std::size_t inside = 0;
  double deepest = 0;
  for (auto v = depth->cbeginValueOn(); v; ++v) {
    const double expected = boxDepth(depth->indexToWorld(v.getCoord()));
    ASSERT_NEAR(*v, expected, 1e-6);
    inside += expected > 0;
    deepest = std::max(deepest, double(*v));
  }
  // Beyond any narrow band, and all of the box.
  EXPECT_GT(deepest, 10 * surface->voxelSize()[0]);
  EXPECT_NEAR(double(inside) * std::pow(surface->voxelSize()[0], 3), 2.1 * 1.3 * 1.7, 0.1);
}

TEST(DistanceTransfer, OneCallGivesBothSolidsAndTheFigures) {
  const Solid source(shapes::box(kLower, kUpper));
  const Solid target(shapes::box(2 * kLower, 2 * kUpper));
  const Mat3 twice{{{2, 0, 0}, {0, 2, 0}, {0, 0, 2}}};
  const DistanceTransfer made =
      transferDistance(affineMap(twice, {}), source, target, {.resolution = 40});
  EXPECT_EQ(made.source.depth->getName(), "source_distance");
  EXPECT_EQ(made.target.depth->getName(), "distance");
  EXPECT_EQ(made.through->getName(), "distance");
  const double voxel = made.source.surface->voxelSize()[0];
  EXPECT_NEAR(made.target.surface->voxelSize()[0], 2 * voxel, 1e-9);
  EXPECT_EQ(made.throughFigures.voxels, made.source.figures.voxels);
  EXPECT_NEAR(made.source.figures.largest, 0.65, voxel);
  EXPECT_NEAR(made.throughFigures.largest, 2 * made.source.figures.largest, 1e-5);
  EXPECT_EQ(made.outsideFraction, 0);
  ASSERT_EQ(made.seconds.size(), 4u);
  EXPECT_EQ(made.seconds[3].first, "transfer");
  // Moved half out of the target.
  const DistanceTransfer half =
      transferDistance(affineMap(twice, {2.1, 0, 0}), source, target, {.resolution = 40});
  EXPECT_NEAR(half.outsideFraction, 0.5, 0.03);
  EXPECT_EQ(half.throughFigures.negative > 0, true);
}

TEST(DistanceTransfer, SourcesThinnerThanTheVoxelsAreRefused) {
  const Solid plate(shapes::box({0, 0, 0.012}, {1, 1, 0.0121}));
  const Mat3 identity{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  EXPECT_THROW(transferDistance(affineMap(identity, {}), plate, plate, {.resolution = 8}),
               DataError);
  EXPECT_THROW(transferDistance(affineMap(identity, {}), plate, plate, {.resolution = 1}),
               SettingError);
}

TEST(DistanceTransfer, OverlappingTargetsAreTheirUnion) {
  Mesh two = shapes::box({-1, -1, -1}, {0.5, 1, 1});
  const Mesh other = shapes::box({-0.5, -1, -1}, {1, 1, 1});
  for (const auto& t : other.triangles) two.triangles.push_back({t[0] + 8, t[1] + 8, t[2] + 8});
  two.vertices.insert(two.vertices.end(), other.vertices.begin(), other.vertices.end());
  const Solid target(two);
  auto map = openvdb::Vec3fGrid::create();
  for (int i = 0; i < 9; ++i)
    map->tree().setValueOn(openvdb::Coord(i, 0, 0), openvdb::Vec3f(-1.2f + 0.3f * float(i), 0, 0));
  const auto depth = depthThrough(*map, target);
  for (int i = 0; i < 9; ++i)
    EXPECT_NEAR(depth->tree().getValue(openvdb::Coord(i, 0, 0)), 1 - std::abs(-1.2 + 0.3 * i),
                1e-5 + 2 * target.gap());
}

}  // namespace
}  // namespace innermap
