#include <gtest/gtest.h>

#include <limits>

#include "innermap/core/error.h"
#include "innermap/core/run.h"
#include "innermap/transfer/inverse_map.h"
#include "transfer/test_maps.h"

namespace innermap {
namespace {

using namespace test;

Points randomPoints(std::size_t count, double radius) {
  Draws draw(3);
  Points out;
  while (out.size() < count) {
    const Vec3 p{2 * draw() - 1, 2 * draw() - 1, 2 * draw() - 1};
    if (norm(p) < 1) out.push_back(radius * p);
  }
  return out;
}

double largest(const Mat3& a, const Mat3& b) {
  double out = 0;
  for (int k = 0; k < 9; ++k) out = std::max(out, std::abs(a[k / 3][k % 3] - b[k / 3][k % 3]));
  return out;
}

TEST(CarryPoints, PushAgreesWithDirectSums) {
  const ComposedMap map = chargedMap();
  const Points points = randomPoints(3000, 0.95);
  const PointPusher pusher{Solid(ball())};
  const CarriedPoints plain = pusher.push(map, points, false),
                      full = pusher.push(map, points, true);
  EXPECT_TRUE(plain.jacobians.empty());
  EXPECT_EQ(full.outside + full.cut + full.failed, 0u);
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_LE(norm(plain.points[i] - map(points[i])), 1e-6);
    EXPECT_LE(norm(full.points[i] - map(points[i])), 1e-6);
    EXPECT_LE(largest(full.jacobians[i], map.jacobian(points[i])), 1e-5);
  }
}

TEST(CarryPointsRelease, PullBringsBack) {
  // Two steps, one after the other.
  const ComposedMap map({chargedMap(0.2), affineMap(rotation(0.4, 1.1), {3, -1, 2})});
  const Solid source(ball()), target(moved(ball(), map));
  const Points points = randomPoints(3000, 0.9);
  const CarriedPoints there = PointPusher(source).push(map, points, true);
  const CarriedPoints back = PointPuller(map, source, target).pull(there.points, true);
  EXPECT_EQ(back.cut + back.failed, 0u);
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_LE(norm(back.points[i] - points[i]), 1e-5);
    EXPECT_LE(largest(product(back.jacobians[i], there.jacobians[i]),
                      {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}),
              1e-4);
  }
}

TEST(CarryPoints, OneInverseServesCallsWithRunsOfTheirOwn) {
  const ComposedMap map(chargedMap());
  const Solid source(ball()), target(moved(ball(), map));
  const PointPuller puller = [&] {
    RunContext over;  // gone before the first call
    const RunScope scope(over);
    return PointPuller(map, source, target);
  }();
  const Points images = {map({0.1, 0.2, 0.3})};
  EXPECT_LE(norm(puller.pull(images, false).points[0] - Vec3{0.1, 0.2, 0.3}), 1e-5);
  RunContext cancelled;
  cancelled.cancel();
  const RunScope scope(cancelled);
  EXPECT_THROW(puller.pull(images, false), Cancelled);
}

TEST(CarryPointsRelease, OutsideIsCutExtendedOrFaded) {
  const ComposedMap map = affineMap(rotation(0.7, 0.2), {1, 2, 3});
  const Solid solid(ball());
  const double diagonal = solid.diagonal();
  const Points points = {{0, 0, 0.5}, {0, 0, 1 + 0.05 * diagonal}, {0, 0, 9}};
  const CarriedPoints cut = PointPusher(solid).push(map, points, false);
  EXPECT_EQ(cut.outside, 2u);
  EXPECT_EQ(cut.cut, 2u);
  EXPECT_EQ(cut.fates[0], PointFate::carried);
  CarryPointsSettings settings;
  settings.outside.distance = 0.1;
  const CarriedPoints near = PointPusher(solid, settings).push(map, points, true);
  EXPECT_EQ(near.outside, 2u);
  EXPECT_EQ(near.cut, 1u);
  EXPECT_NEAR(near.farthest, 0.05, 5e-3);
  EXPECT_LE(norm(near.points[1] - map(points[1])), 1e-6);
  settings.outside.fadeTo = RigidMotion{};
  const PointPusher fading(solid, settings);
  const CarriedPoints faded = fading.push(map, points, true);
  EXPECT_EQ(faded.cut, 0u);
  EXPECT_LE(norm(faded.points[2] - points[2]), 1e-12);
  // And back again, the far point too.
  const Solid target(moved(ball(), map));
  const CarriedPoints back = PointPuller(map, solid, target, settings).pull(faded.points, false);
  EXPECT_LE(norm(back.points[0] - points[0]), 1e-5);
  EXPECT_LE(norm(back.points[2] - points[2]), 1e-5);
}

// What is placed once goes through any map as points do, with other motions outside.
TEST(CarryPoints, PlacedPointsServeManyMaps) {
  const Solid solid(ball());
  const Points points = {{0, 0, 0.5}, {0, 0, 1 + 0.05 * solid.diagonal()}, {0, 0, 9}};
  CarryPointsSettings settings;
  settings.outside.distance = 0.1;
  const PointPusher pusher(solid, settings);
  const PlacedPoints placed = pusher.place(points);
  const std::vector<PointFate> fates = {PointFate::carried, PointFate::carried, PointFate::cut};
  EXPECT_EQ(placed.fates, fates);
  for (const double strength : {0.1, 0.3}) {
    const HarmonicMap map = chargedMap(strength);
    for (const bool jacobians : {false, true}) {
      const CarriedPoints once = pusher.push(map, placed, jacobians),
                          anew = pusher.push(map, points, jacobians);
      EXPECT_EQ(once.fates, fates);
      for (std::size_t i = 0; i < 2; ++i) EXPECT_EQ(norm(once.points[i] - anew.points[i]), 0);
    }
    const RigidMotion motion{rotation(0.3, 0.1), {strength, 2, 3}};
    const CarriedPoints far = pusher.fadingTo(motion).push(map, placed, false);
    EXPECT_EQ(far.cut, 0u);
    EXPECT_LE(norm(far.points[2] - motion(points[2])), 1e-12);
  }
}

TEST(CarryPoints, DirectionsTurn) {
  const Mat3 stretch{{{2, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  // The plane x + y = 0 becomes x / 2 + y = 0.
  const Vec3 normal = carriedNormal(stretch, {1, 1, 0});
  EXPECT_NEAR(normal.x / normal.y, 0.5, 1e-14);
  EXPECT_NEAR(norm(normal), std::sqrt(2.0), 1e-14);
  EXPECT_NEAR(carriedVector(stretch, {1, 1, 0}).x, 2, 1e-14);
  // Mirrored: what was in front stays in front.
  EXPECT_NEAR(carriedNormal({{{-1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}, {1, 0, 0}).x, -1, 1e-14);
  EXPECT_NEAR(carriedNormal({}, {0, 3, 0}).y, 3, 1e-14);
}

TEST(CarryPoints, BadInput) {
  const PointPusher pusher{Solid(ball())};
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(pusher.push(chargedMap(), {{0, nan, 0}}, false), DataError);
  EXPECT_THROW(PointPusher(Solid(ball()), {.skin = 1}), SettingError);
  RunContext run;
  run.cancel();
  const RunScope scope(run);
  EXPECT_THROW(pusher.push(chargedMap(), randomPoints(10, 0.5), false), Cancelled);
  EXPECT_GT(carryPointsMemory(1000000, true), 72000000u);
}

}  // namespace
}  // namespace innermap
