#include "innermap/fit/fit_map.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/expect.h"
#include "fit/test_pairs.h"
#include "innermap/core/error.h"
#include "innermap/core/run.h"

namespace innermap {
namespace {

// Of the map against `exact` at points inside, over the target's diagonal.
double errorInside(const MapFit& fit, const std::function<Vec3(const Vec3&)>& exact) {
  double largest = 0;
  for (int i = 0; i < 200; ++i) {
    const double a = 2.4 * i, z = -0.8 + 1.6 * i / 199, r = 0.5 * (i % 7) / 6.0;
    const Vec3 p{r * std::cos(a), r * std::sin(a), z * 0.9};
    largest = std::max(largest, norm(fit.map(p) - exact(p)));
  }
  return largest / fit.boundary.target.diagonal;
}

TEST(FitMap, AffineMapsAreExact) {
  const Mesh source = ball();
  const MapFit fit = fitMap(source, moved(source, affineMap));
  ASSERT_TRUE(fit.tolerance);
  EXPECT_TRUE(fit.tolerance->met);
  EXPECT_LT(fit.error.max, 1e-10);
  EXPECT_LT(errorInside(fit, affineMap), 1e-10);
}

// What linear interpolation between the moved vertices can be off: h^2 / 6 times the largest second
// derivative of harmonicPolynomial in any direction, which is under 0.23 (components 0.2, 0.1,
// 0.05). Fraction of the diagonal.
double chordError(const Mesh& mesh, double diagonal) {
  double longest = 0;
  for (const Triangle& t : mesh.triangles)
    for (int k = 0; k < 3; ++k)
      longest = std::max(longest, norm(mesh.vertices[t[k]] - mesh.vertices[t[(k + 1) % 3]]));
  return longest * longest / 6 * 0.23 / diagonal;
}

// The certificate is against the triangles, and bounds the error inside up to what they cut off.
TEST(FitMapRelease, CertificateBoundsTheErrorInside) {
  const Mesh source = ball();
  const Mesh target = moved(source, harmonicPolynomial);
  for (const Interpolation interpolation : {Interpolation::linear, Interpolation::automatic}) {
    FitMapSettings settings{.interpolation = interpolation};
    const MapFit fit = fitMap(source, target, settings);
    EXPECT_TRUE(fit.tolerance->met);
    EXPECT_LE(fit.error.p99, settings.tolerance);
    EXPECT_LT(errorInside(fit, harmonicPolynomial),
              fit.error.max + chordError(source, fit.boundary.target.diagonal));
    EXPECT_EQ(fit.error.samples, 20000u);
  }
}

TEST(FitMap, VerticesOfASmoothDeformationAreRecognised) {
  const Mesh source = ball();
  const MapFit fit = fitMap(source, moved(source, harmonicPolynomial));
  EXPECT_TRUE(fit.smooth);
  ASSERT_TRUE(fit.verticesRms);
  EXPECT_LT(*fit.verticesRms, 1e-6);
  EXPECT_LT(errorInside(fit, harmonicPolynomial), 1e-6);
}

// A ball pushed in deeply: one harmonic map folds there.
Vec3 dented(const Vec3& p) {
  const double angle = std::acos(std::clamp(p.z / norm(p), -1.0, 1.0));
  return p - Vec3{0, 0, 0.85 * std::exp(-angle * angle / 0.36)};
}

TEST(FitMapRelease, GoesInStepsWhereOneMapFolds) {
  const Mesh source = ball(4), target = moved(source, dented);
  FitMapSettings settings{.tolerance = 2e-3, .oneToOne = OneToOne::off};
  const MapFit single = fitMap(source, target, settings);
  EXPECT_EQ(single.map.steps().size(), 1u);
  EXPECT_GT(single.inside.folded, 5e-3);
  // The single map turns points over, on the axis below the dent.
  const auto least = [](const MapFit& fit) {
    double det = 1;
    for (double z = 0; z < 0.97; z += 0.01)
      det = std::min(det, determinant(fit.map.jacobian({0.01, 0.01, z})));
    return det;
  };
  EXPECT_LT(least(single), 0);
  for (const OneToOne oneToOne : {OneToOne::automatic, OneToOne::on}) {
    settings.oneToOne = oneToOne;
    const MapFit steps = fitMap(source, target, settings);
    EXPECT_GE(steps.map.steps().size(), 2u);
    EXPECT_EQ(steps.steps.size(), steps.map.steps().size());
    EXPECT_LE(steps.inside.folded, oneToOne == OneToOne::on ? 0 : kFewFolds);
    EXPECT_LT(steps.inside.outside, 1e-3);
    EXPECT_TRUE(steps.tolerance->met);
    EXPECT_LE(steps.error.p99, settings.tolerance);
    EXPECT_GT(least(steps), 0);
  }
}

TEST(FitMapRelease, StepsThatDoNotFitAreLeft) {
  const Mesh source = ball(4);
  const MemoryLimit limit(kStepsMemory);
  const MapFit fit = fitMap(source, moved(source, dented), {.tolerance = 1e-2});
  EXPECT_EQ(fit.map.steps().size(), 1u);
  EXPECT_GT(fit.inside.folded, kManyFolds);
  const bool said = std::any_of(fit.warnings.begin(), fit.warnings.end(), [](const auto& warning) {
    return warning.find("steps may need") != std::string::npos;
  });
  EXPECT_TRUE(said);
}

// The certificate of the whole: against the map's own values at boundary points.
TEST(FitMapRelease, StepsAreCertifiedEndToEnd) {
  const Mesh source = ball(4), target = moved(source, dented);
  const MapFit fit = fitMap(source, target, {.tolerance = 4e-3, .oneToOne = OneToOne::on});
  double farthest = 0;
  for (std::size_t v = 0; v < source.vertices.size(); ++v)
    farthest = std::max(farthest, norm(fit.map(source.vertices[v]) - target.vertices[v]));
  // Vertices are boundary points like any: nearly none is farther than the farthest sample.
  EXPECT_LT(farthest / fit.boundary.target.diagonal, 2 * fit.error.max);
}

TEST(FitMapRelease, SaysWhatItKnowsOfOneToOne) {
  const Mesh source = ball();
  const Injectivity known = fitMap(source, moved(source, harmonicPolynomial), {}).injectivity;
  // The determinant of harmonicPolynomial is about 1 + 0.2 x, and 0.796 at x = -1.
  EXPECT_NEAR(known.inside.least, 0.81, 0.02);
  EXPECT_NEAR(known.boundary.least, 0.795, 0.01);
  EXPECT_LT(known.boundary.least, known.inside.least);
  EXPECT_EQ(known.inside.folded + known.boundary.folded, 0u);
  EXPECT_EQ(known.degree.least, 1);
  EXPECT_EQ(known.degree.greatest, 1);
  EXPECT_GT(known.degree.checked, 1500u);
  EXPECT_EQ(known.cells.checked, 0u);
  EXPECT_FALSE(notOneToOne(known));
  EXPECT_GT(fitMap(source, source, {.oneToOne = OneToOne::off}).injectivity.inside.checked, 15000u);
}

TEST(FitMap, OneStepIsEnoughForGentleMaps) {
  const Mesh source = ball();
  const MapFit fit = fitMap(source, moved(source, harmonicPolynomial));
  EXPECT_TRUE(fit.steps.empty());
  EXPECT_EQ(fit.inside.folded, 0);
  EXPECT_GT(fit.inside.samples, 15000u);
  EXPECT_THROW(fitMap(source, source, {.shell = ShellSettings{}, .oneToOne = OneToOne::on}),
               SettingError);
}

TEST(FitMapRelease, ShellsOfMoreChargesAreMoreExact) {
  const Mesh source = ball();
  const Mesh target = moved(source, harmonicPolynomial);
  FitMapSettings settings;
  settings.interpolation = Interpolation::linear;
  settings.shell = ShellSettings{};
  double last = 1;
  for (const std::size_t sources : {50, 200, 800}) {
    settings.shell->sources = sources;
    const MapFit fit = fitMap(source, target, settings);
    EXPECT_EQ(fit.solve.sources, sources);
    EXPECT_EQ(fit.solve.placement, MapPlacement::shell);
    EXPECT_FALSE(fit.tolerance);
    EXPECT_LT(fit.error.rms, last);
    last = fit.error.rms;
  }
}

TEST(FitMap, ChargesOnASphere) {
  FitMapSettings settings{.shell = ShellSettings{}};
  settings.shell->sources = 200;
  settings.shell->radiusRatio = 2;
  settings.shell->method = Regularization::truncatedSvd;
  const Mesh source = ball();
  const MapFit fit = fitMap(source, moved(source, harmonicPolynomial), settings);
  EXPECT_EQ(fit.solve.placement, MapPlacement::sphere);
  EXPECT_EQ(fit.solve.method, SolveMethod::truncatedSvd);
  EXPECT_EQ(fit.solve.radiusRatio, 2);
  EXPECT_LT(errorInside(fit, harmonicPolynomial), 1e-3);
}

TEST(FitMapRelease, AToleranceThatCannotBeMetIsSaidNotThrown) {
  Mesh source = ball(2);
  Mesh target = source;
  for (std::size_t v = 0; v < target.vertices.size(); v += 2)
    target.vertices[v] = 1.3 * target.vertices[v];  // kinks at every edge
  const MapFit fit = fitMap(source, target, {.tolerance = 1e-6, .maxSources = 1000});
  ASSERT_TRUE(fit.tolerance);
  EXPECT_FALSE(fit.tolerance->met);
  EXPECT_EQ(fit.tolerance->end, AdaptiveEnd::maxSources);
  EXPECT_GT(fit.tolerance->reached, 1e-6);
  EXPECT_NE(std::find(fit.facts.begin(), fit.facts.end(),
                      std::pair<std::string, std::string>{"tolerance_met", "false"}),
            fit.facts.end());
}

TEST(FitMapRelease, SameForAnyNumberOfThreads) {
  const Mesh source = ball(2);
  const Mesh target = moved(source, harmonicPolynomial);
  const auto weights = [&](int threads) {
    const ThreadLimit limit(threads);
    return fitMap(source, target).map.steps().front().field().weights();
  };
  const Matrix one = weights(1), three = weights(3);
  ASSERT_EQ(one.rows(), three.rows());
  for (std::size_t i = 0; i < one.rows() * one.columns(); ++i)
    ASSERT_EQ(one.data()[i], three.data()[i]);
}

TEST(FitMap, TellsOfTheBoundariesWhenGivenMeshes) {
  Mesh open = ball(2);
  open.triangles.resize(open.triangles.size() - 4);
  const MapFit fit = fitMap(open, moved(open, affineMap));
  EXPECT_FALSE(fit.notes.empty());
  std::vector<std::string> stages;
  for (const auto& [stage, seconds] : fit.seconds) stages.push_back(stage);
  EXPECT_EQ(stages.front(), "check");
  EXPECT_NE(std::find(stages.begin(), stages.end(), "fit"), stages.end());
}

TEST(FitMap, RefusesSettingsOutsideTheirRange) {
  const Mesh source = ball(2);
  FitMapSettings settings{.tolerance = 0};
  EXPECT_THROW(fitMap(source, source, settings), SettingError);
  settings = {};
  settings.shell = ShellSettings{};
  settings.shell->distance = 0.1;
  settings.shell->radiusRatio = 2;
  EXPECT_THROW(fitMap(source, source, settings), SettingError);
  settings.shell->radiusRatio.reset();
  settings.shell->sources = 100;
  settings.shell->collocation = 50;
  EXPECT_THROW(fitMap(source, source, settings), SettingError);
}

TEST(FitMap, CountsItsMemory) {
  FitMapSettings settings{.shell = ShellSettings{}};
  const std::uint64_t few = fitMapMemory(settings, 1000);
  settings.shell->sources = 20000;
  settings.shell->solver = FitSolver::dense;
  const std::uint64_t many = fitMapMemory(settings, 1000);
  EXPECT_GT(many, 20000u * 80000u * 8u);
  EXPECT_LT(few, many / 10);
  EXPECT_GT(fitMapMemory(settings, 100'000'000), many);
}

TEST(FitMap, Cancels) {
  test::expectCancels([&] { fitMap(ball(2), ball(2), {}); });
}

}  // namespace
}  // namespace innermap
