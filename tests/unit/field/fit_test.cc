#include "innermap/field/fit.h"

#include <gtest/gtest.h>

#include "core/expect.h"
#include "field/sphere_problem.h"
#include "innermap/core/error.h"

namespace innermap {
namespace {

TEST(Fit, SmoothValuesChooseAFarShell) {
  const FitProblem p = testing::ballProblem(1600);
  const FitResult r = fitField(p, {.sources = 400});
  // The nearest shell is at 0.8 sqrt(4 pi / 400) / sqrt(12) = 0.041.
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
  kink(p.surface.points, p.surface.values);
  kink(p.surface.heldOut, p.surface.heldOutValues);
  EXPECT_LT(fitField(p, {.sources = 800}).distance, 0.1);
}

TEST(Fit, GivenDistanceIsTaken) {
  const FitProblem p = testing::ballProblem(900);
  const FitResult r = fitField(p, {.sources = 200, .distance = 0.123});
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
  EXPECT_LE(fitField(p, {.sources = 400}).distance, 0.15);
}

// Values at the vertices from a smooth function, between them off by 1e-3.
FitProblem sampledProblem() {
  FitProblem p = testing::ballProblem(1600);
  p.vertices = p.surface;
  const CounterRandom random(3, 3);
  const auto disturb = [&](Matrix& v, std::uint64_t stream) {
    for (std::size_t i = 0; i < v.rows() * v.columns(); ++i)
      v.data()[i] += 1e-3 * (random.uniform(2 * i + stream) - 0.5);
  };
  disturb(p.surface.values, 0);
  disturb(p.surface.heldOutValues, 1);
  return p;
}

TEST(Fit, SmoothSamplesAreFittedAtTheVertices) {
  const FitProblem p = sampledProblem();
  const FitResult r = fitField(p, {.sources = 400});
  EXPECT_TRUE(r.smooth);
  const Points inside = testing::spherePoints(500, 0.7, 0.3);
  EXPECT_LT(measureBoundaryError(r.field, inside, testing::harmonicMapValues(inside), 1).max, 1e-7);
  const FitResult linear = fitField(p, {.sources = 400, .interpolation = Interpolation::linear});
  EXPECT_FALSE(linear.smooth);
  EXPECT_GT(measureBoundaryError(linear.field, inside, testing::harmonicMapValues(inside), 1).max,
            1e-6);
}

TEST(Fit, OnlySmoothSamplesHaveASmoothFit) {
  FitProblem p = sampledProblem();
  const std::optional<FitResult> r = fitSmooth(p, {.sources = 400});
  ASSERT_TRUE(r);
  EXPECT_TRUE(r->smooth);
  p.vertices.values = p.surface.values;
  p.vertices.heldOutValues = p.surface.heldOutValues;
  EXPECT_FALSE(fitSmooth(p, {.sources = 400}));
  EXPECT_TRUE(fitSmooth(p, {.sources = 400, .interpolation = Interpolation::smooth}));
}

TEST(Fit, RoughVerticesStayLinear) {
  FitProblem p = sampledProblem();
  p.vertices.values = p.surface.values;
  p.vertices.heldOutValues = p.surface.heldOutValues;
  EXPECT_FALSE(fitField(p, {.sources = 400}).smooth);
}

TEST(Fit, FewVerticesTakeFewerSources) {
  FitProblem p = sampledProblem();
  p.vertices.points.resize(300);
  Matrix values(300, 3);
  for (std::size_t k = 0; k < 3; ++k)
    std::copy_n(p.vertices.values.column(k), 300, values.column(k));
  p.vertices.values = values;
  EXPECT_EQ(
      fitField(p, {.sources = 400, .interpolation = Interpolation::smooth}).field.sources().size(),
      150u);
}

TEST(FitRelease, ManySourcesAreSolvedForIteratively) {
  FitProblem p = testing::ballProblem(12000);
  for (std::size_t i = 0; i < p.surface.points.size(); ++i)
    p.surface.values(i, 0) += std::abs(std::sin(5 * p.surface.points[i].x));
  for (std::size_t i = 0; i < p.surface.heldOut.size(); ++i)
    p.surface.heldOutValues(i, 0) += std::abs(std::sin(5 * p.surface.heldOut[i].x));
  const FitResult many = fitField(p, {.sources = 4000});
  EXPECT_TRUE(many.iterative);
  EXPECT_GE(many.residuals.size(), 2u);
  const FitResult few = fitField(p, {.sources = 1000});
  EXPECT_FALSE(few.iterative);
  const auto rms = [&](const FitResult& r) {
    return measureBoundaryError(r.field, p.surface.heldOut, p.surface.heldOutValues, 1).rms;
  };
  // Kinks: at least first order in the spacing, so half, and something for points that are random
  // instead of blue noise: 3 a source for the many, 12 for the few.
  EXPECT_LT(rms(many), 0.7 * rms(few));
  EXPECT_THROW(fitField(p, {.sources = 1000, .solver = FitSolver::iterative, .distance = 0.5}),
               SettingError);
}

TEST(Fit, RefusesBadSettings) {
  const FitProblem p = testing::ballProblem(900);
  FitSettings s{.sources = 0};
  EXPECT_THROW(fitField(p, s), SettingError);
  s.sources = 200;
  s.distance = -1;
  EXPECT_THROW(fitField(p, s), SettingError);
  s.distance.reset();
  test::expectOverLimit(1000, [&] { fitField(p, s); });
}

}  // namespace
}  // namespace innermap
