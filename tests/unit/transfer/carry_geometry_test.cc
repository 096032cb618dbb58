#include <gtest/gtest.h>

#include <cmath>

#include "core/expect.h"
#include "innermap/core/error.h"
#include "innermap/transfer/geometry.h"

namespace innermap {
namespace {

// A bend that takes the line y = z = 0 to a parabola; points beyond x = 2 are cut.
CarriedPoints bend(const Points& points, bool jacobians) {
  CarriedPoints out;
  for (const Vec3& p : points) {
    out.points.push_back({p.x, p.y + p.x * p.x, p.z});
    if (jacobians) out.jacobians.push_back({{{1, 0, 0}, {2 * p.x, 1, 0}, {0, 0, 1}}});
    out.fates.push_back(p.x > 2 ? PointFate::cut : PointFate::carried);
    out.cut += p.x > 2;
  }
  return out;
}

Geometry line(double length) {
  Geometry g{.points = {{0, 0, 0}, {length, 0, 0}}, .ownPoints = 2};
  const Corner corners[2] = {{0, -1, -1}, {1, -1, -1}};
  g.elements.add(Elements::Kind::line, 0, corners, 2);
  return g;
}

TEST(CarryGeometry, SplitsUntilStraightIsNear) {
  for (const double tolerance : {0.1, 1e-2, 1e-4}) {
    Geometry g = line(2);
    const CarriedGeometry carried = carryGeometry(g, bend, {.subdivide = tolerance});
    // The chord of a parabola of width h is h^2 / 4 away from it.
    const double width = std::pow(2, -std::ceil(std::log2(2 / std::sqrt(4 * tolerance))));
    EXPECT_EQ(carried.added + 1, static_cast<std::uint64_t>(std::lround(1 / width)));
    EXPECT_EQ(g.elements.size(), 1u);
    EXPECT_EQ(g.elements.corners.size(), carried.added + 2);
    EXPECT_EQ(carried.ownPoints, 2u);
  }
}

TEST(CarryGeometry, TurnsDirectionsAndLeavesOutWhatIsCut) {
  Geometry g = line(3);
  g.directions.push_back({"n", DirectionKind::normal, {{0, 1, 0}}, {0}});
  g.directions.push_back({"v", DirectionKind::vector, {{1, 0, 0}}, {1}});
  const CarriedGeometry carried = carryGeometry(g, bend);
  EXPECT_EQ(carried.cutElements, 1u);
  EXPECT_EQ(carried.stays[0], 0);
  EXPECT_EQ(carried.number, (std::vector<int>{0, -1}));
  EXPECT_NEAR(carried.directions[0][0].y, 1, 1e-15);
  EXPECT_NEAR(carried.directions[1][0].y, 6, 1e-15);
  EXPECT_EQ(carried.folded, 0u);
}

// Onto a target that is inside out det J is below 0 where nothing folds.
TEST(CarryGeometry, FoldsAreToldByTheMapsSense) {
  for (const bool mirrored : {false, true}) {
    Geometry g = line(3);
    g.directions.push_back({"n", DirectionKind::normal, {{0, 1, 0}}, {0}});
    EXPECT_EQ(carryGeometry(g, bend, {.mirrored = mirrored}).folded, mirrored ? 2u : 0u);
  }
}

TEST(CarryGeometry, Limits) {
  Geometry g = line(2);
  test::expectOverLimit(100000, [&] { carryGeometry(g, bend, {.subdivide = 1e-12}); });
  EXPECT_THROW(carryGeometry(g, bend, {.subdivide = -1}), SettingError);
  g.splittable = false;
  EXPECT_THROW(carryGeometry(g, bend, {.subdivide = 0.1}), SettingError);
  EXPECT_GT(carryGeometryMemory(g), 0u);
}

}  // namespace
}  // namespace innermap
