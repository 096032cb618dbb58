#include "levelset/offset_surface.h"

#include <gtest/gtest.h>

#include "core/expect.h"
#include "core/random.h"
#include "mesh/shapes.h"

namespace innermap {
namespace {

void expectAtDistance(const Solid& solid, const Mesh& mesh, double distance) {
  ASSERT_FALSE(mesh.triangles.empty());
  validate(mesh);
  for (const Vec3& p : mesh.vertices) {
    ASSERT_FALSE(solid.inside(p));
    ASSERT_NEAR(solid.distance(p), distance, 0.05 * distance);
  }
}

TEST(OffsetSurfaceRelease, OfABallIsABall) {
  const Solid solid(shapes::icosphere(4));
  for (const double d : {1e-4, 0.0024, 0.0026, 0.05, 0.3, 2.0}) {
    SCOPED_TRACE(d);
    const Mesh mesh = offsetSurface(solid, {d});
    const double distance = d * solid.diagonal();
    expectAtDistance(solid, mesh, distance);
    const double r = 1 + distance;
    // Chords of triangles of 1/8 of the radius at most lose well under 2%.
    EXPECT_NEAR(surfaceArea(mesh), 4 * kPi * r * r, 0.03 * 4 * kPi * r * r);
    EXPECT_NEAR(signedVolume(mesh), 4.0 / 3 * kPi * r * r * r, 0.03 * 4.0 / 3 * kPi * r * r * r);
  }
}

TEST(OffsetSurface, BetweenPartsOnlyWhereThereIsRoom) {
  // Two boxes 0.2 apart; a sheet between them exists for distances under 0.1 only.
  const Solid solid(
      shapes::joined(shapes::box({0, 0, 0}, {1, 1, 1}), shapes::box({1.2, 0, 0}, {2.2, 1, 1})));
  const auto between = [&](double world) {
    const Mesh mesh = offsetSurface(solid, {world / solid.diagonal()});
    expectAtDistance(solid, mesh, world);
    int count = 0;
    for (const Vec3& p : mesh.vertices) {
      count += p.x > 1 && p.x < 1.2 && p.y > 0.3 && p.y < 0.7 && p.z > 0.3 && p.z < 0.7;
    }
    return count;
  };
  EXPECT_GT(between(0.03), 20);
  EXPECT_EQ(between(0.12), 0);
}

TEST(OffsetSurface, InsideSheetsAreLeftOutCavitiesAreNot) {
  const Solid hollow(
      shapes::joined(shapes::icosphere(4), shapes::flipped(shapes::icosphere(4, 0.5))));
  const Mesh mesh = offsetSurface(hollow, {0.02});
  const double distance = 0.02 * hollow.diagonal();
  expectAtDistance(hollow, mesh, distance);
  std::size_t cavity = 0;
  for (const Vec3& p : mesh.vertices) cavity += norm(p) < 0.5;
  EXPECT_GT(cavity, 100u);
  EXPECT_LT(cavity, mesh.vertices.size() / 2);
}

TEST(OffsetSurface, PartsThatOverlapGiveTheUnion) {
  const Solid solid(
      shapes::joined(shapes::icosphere(3), shapes::icosphere(3, 0.8, {0.9, 0.1, 0.2})));
  for (const double d : {0.001, 0.02})
    expectAtDistance(solid, offsetSurface(solid, {d}), d * solid.diagonal());
}

TEST(OffsetSurface, MovePointsToTheDistance) {
  const Solid solid(shapes::icosphere(4));
  for (const double r : {0.5, 1.01, 1.3, 4.0}) {
    Vec3 p = r / std::sqrt(3.0) * Vec3{1, 1, 1};
    EXPECT_LT(moveToDistance(solid, 0.2, p), 1e-9);
    EXPECT_NEAR(solid.distance(p), 0.2, 1e-9);
    Vec3 other = r / std::sqrt(3.0) * Vec3{1, 1, 1};
    const auto nowhere = [](const Vec3&, const Solid::Closest&) { return false; };
    EXPECT_TRUE(std::isinf(moveToDistance(solid, 0.2, other, 1e-9, nowhere)));
  }
}

TEST(OffsetSurface, MovedPointsAreNoFurtherOffThanTold) {
  const Solid solid(
      shapes::joined(shapes::icosphere(2), shapes::icosphere(2, 0.8, {0.9, 0.1, 0.2})));
  const CounterRandom random(17, 0);
  constexpr double kDistance = 0.2;
  int settled = 0;
  for (std::size_t i = 0; i < 600; ++i) {
    const double enough = i % 2 == 0 ? 1e-9 : 0.03;
    Vec3 p{4 * random.uniform(3 * i) - 2, 4 * random.uniform(3 * i + 1) - 2,
           4 * random.uniform(3 * i + 2) - 2};
    const double off = moveToDistance(solid, kDistance, p, enough);
    const double distance = solid.distance(p);
    EXPECT_NEAR(distance, kDistance, off + 1e-12);
    settled += off <= enough * kDistance;
    EXPECT_TRUE(isNearer(solid, p, distance * (1 + 1e-12)));
    EXPECT_FALSE(isNearer(solid, p, distance * (1 - 1e-12)));
  }
  EXPECT_GT(settled, 500);
}

TEST(OffsetSurface, SettingsAndCancelling) {
  const Solid solid(shapes::icosphere(2));
  for (const double d : {0.0, 9e-5, 2.1, -1.0, std::nan("")})
    EXPECT_THROW(offsetSurface(solid, {d}), SettingError);
  test::expectCancels([&] { offsetSurface(solid, {0.05}); });
  test::expectCancels([&] { offsetSurface(solid, {0.001}); });
}

}  // namespace
}  // namespace innermap
