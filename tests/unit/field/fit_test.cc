#include "innermap/field/fit.h"

#include <gtest/gtest.h>

#include "field/sphere_problem.h"
#include "innermap/core/error.h"
#include "innermap/field/boundary_error.h"

namespace innermap {
namespace {

TEST(Fit, SmoothValuesChooseAFarShell) {
  const FitProblem p = testing::ballProblem(1600);
  FitSettings s;
  s.sources = 400;
  const FitResult r = fitField(p, s);
  // The nearest shell is at 1.25 sqrt(4 pi / 400) / sqrt(12) = 0.064.
  EXPECT_GT(r.distance, 0.2);
  EXPECT_GE(r.trials.size(), 3u);
  const Points fresh = testing::spherePoints(5000, 1, 0.3);
  const BoundaryError e =
      measureBoundaryError(r.field, fresh, testing::harmonicMapValues(fresh), 1);
  EXPECT_LT(e.max, 1e-7);
}

TEST(Fit, KinkedValuesChooseANearShell) {
  FitProblem p = testing::ballProblem(3200);
  const auto kink = [](const Points& points, Matrix& v) {
    for (std::size_t i = 0; i < points.size(); ++i)
      v(i, 0) += std::abs(std::sin(5 * points[i].x)) + std::abs(std::sin(5 * points[i].y));
  };
  kink(p.collocation, p.values);
  kink(p.heldOut, p.heldOutValues);
  FitSettings s;
  s.sources = 800;
  EXPECT_LT(fitField(p, s).distance, 0.1);
}

TEST(Fit, GivenDistanceIsTaken) {
  const FitProblem p = testing::ballProblem(900);
  FitSettings s;
  s.sources = 200;
  s.distance = 0.123;
  const FitResult r = fitField(p, s);
  EXPECT_EQ(r.distance, 0.123);
  EXPECT_TRUE(r.trials.empty());
  EXPECT_EQ(r.field.sources().size(), 200u);
}

TEST(Fit, DistancesWithoutRoomArePassedOver) {
  FitProblem p = testing::ballProblem(1600);
  const auto place = p.placeSources;
  p.placeSources = [place](std::size_t count, double distance) {
    if (distance > 0.15) throw DataError("no room");
    return place(count, distance);
  };
  FitSettings s;
  s.sources = 400;
  EXPECT_LE(fitField(p, s).distance, 0.15);
}

TEST(Fit, RefusesBadSettings) {
  const FitProblem p = testing::ballProblem(900);
  FitSettings s;
  s.sources = 0;
  EXPECT_THROW(fitField(p, s), SettingError);
  s.sources = 200;
  s.distance = -1;
  EXPECT_THROW(fitField(p, s), SettingError);
  s.distance.reset();
  s.maxMemory = 1000;
  EXPECT_THROW(fitField(p, s), MemoryError);
}

}  // namespace
}  // namespace innermap
