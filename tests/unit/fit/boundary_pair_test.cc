#include "innermap/fit/boundary_pair.h"

#include <gtest/gtest.h>

#include "core/expect.h"
#include "fit/test_pairs.h"
#include "innermap/core/error.h"

namespace innermap {
namespace {

TEST(BoundaryPair, TargetsFollowTheMapOfTheVertices) {
  const Mesh source = ball(2);
  const BoundaryPair pair = makeBoundaryPair(source, moved(source, affineMap));
  std::vector<SurfacePoint> samples;
  for (int t = 0; t < 20; ++t) samples.push_back({t, {0.2, 0.3, 0.5}});
  const Matrix targets = pair.targetsOf(samples);
  const Mesh& surface = pair.solid().surface();
  const Points at = interpolate(surface.vertices, surface.triangles, samples);
  ASSERT_EQ(targets.rows(), 20u);
  for (std::size_t i = 0; i < 20; ++i)
    EXPECT_LT(norm(Vec3{targets(i, 0), targets(i, 1), targets(i, 2)} - affineMap(at[i])), 1e-12);
}

TEST(BoundaryPair, KnowsVolumesAndDiagonals) {
  const Mesh source = ball(2);
  const BoundaryPair pair = makeBoundaryPair(source, moved(source, [](const Vec3& p) {
                                               return Vec3{2 * p.x, 3 * p.y, 4 * p.z};
                                             }));
  EXPECT_NEAR(pair.target.volume / pair.solid().volume(), 24, 1e-9);
  EXPECT_NEAR(pair.target.diagonal, boundingBox(pair.targetMesh).diagonal(), 1e-12);
  EXPECT_NEAR(makeTargetSolid(pair).volume(), pair.target.volume, 1e-9 * pair.target.volume);
  EXPECT_TRUE(pair.warnings.empty());
  ASSERT_EQ(pair.seconds.size(), 2u);
  EXPECT_EQ(pair.seconds[0].first, "check");
  EXPECT_EQ(pair.seconds[1].first, "solid");
}

TEST(BoundaryPair, CapsMoveWithTheRim) {
  Mesh open = ball(2);
  open.triangles.resize(open.triangles.size() - 4);
  const BoundaryPair pair = makeBoundaryPair(open, moved(open, affineMap));
  ASSERT_GT(pair.solid().repaired().caps, 0);
  EXPECT_FALSE(pair.notes.empty());
  const Points& rest = pair.solid().repaired().mesh.vertices;
  ASSERT_EQ(pair.target.moved.size(), rest.size());
  for (std::size_t v = 0; v < rest.size(); ++v)
    EXPECT_LT(norm(pair.target.moved[v] - affineMap(rest[v])), 1e-12);
}

TEST(BoundaryPair, CrossingsAreWarnedOfInSourceAndTarget) {
  const Mesh two = shapes::joined(shapes::transformed(ball(2), 1, {0, 0, 0}),
                                  shapes::transformed(ball(2), 1, {1.2, 0.1, 0}));
  const BoundaryPair pair = makeBoundaryPair(two, two);
  ASSERT_EQ(pair.warnings.size(), 2u);
  EXPECT_NE(pair.warnings[0].find("source"), std::string::npos);
  EXPECT_NE(pair.warnings[1].find("target"), std::string::npos);
  EXPECT_GT(pair.targetCheck.selfIntersections, 0u);
}

TEST(BoundaryPair, PartsThatCancelAreWarnedOf) {
  const Mesh source = shapes::joined(ball(2), shapes::transformed(ball(2), 1, {5, 0, 0}));
  Mesh target = source;
  for (std::size_t v = source.vertices.size() / 2; v < source.vertices.size(); ++v)
    target.vertices[v].z = -target.vertices[v].z;
  const BoundaryPair pair = makeBoundaryPair(source, target);
  EXPECT_EQ(pair.target.volume, 0);
  ASSERT_FALSE(pair.warnings.empty());
}

TEST(BoundaryPair, RefusesTargetsWithoutExtentFlatOnesAndOtherConnectivity) {
  const Mesh source = ball(2);
  EXPECT_THROW(makeBoundaryPair(source, moved(source,
                                              [](const Vec3&) {
                                                return Vec3{1, 2, 3};
                                              })),
               DataError);
  EXPECT_THROW(makeBoundaryPair(source, moved(source,
                                              [](const Vec3& p) {
                                                return Vec3{p.x, p.y, 0};
                                              })),
               DataError);
  EXPECT_THROW(makeBoundaryPair(source, ball(3)), DataError);
  Mesh turned = source;
  std::swap(turned.triangles[3][0], turned.triangles[3][1]);
  EXPECT_THROW(makeBoundaryPair(source, turned), DataError);
}

TEST(BoundaryPair, Cancels) {
  test::expectCancels([&] { makeBoundaryPair(ball(2), ball(2)); });
}

}  // namespace
}  // namespace innermap
