#include "fit/detail/step_fit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <mutex>
#include <set>
#include <string>

#include "fit/detail/inside_check.h"
#include "fit/detail/streams.h"
#include "fit/test_pairs.h"
#include "innermap/core/run.h"
#include "innermap/fit/surface_problem.h"
#include "sample/surface_samples.h"

namespace innermap {
namespace {

using Move = std::function<Vec3(const Vec3&)>;

// A long body without corners.
Mesh plainBar() {
  return moved(ball(4), [](const Vec3& p) { return Vec3{0.6 * p.x, 0.5 * p.y, 2 * p.z}; });
}

// About the y axis, so that its middle line becomes an arc of so many radians.
Move bent(double angle) {
  return [angle](const Vec3& p) {
    const double radius = 4 / angle, turn = p.z / radius;
    return Vec3{radius - (radius - p.x) * std::cos(turn), p.y, (radius - p.x) * std::sin(turn)};
  };
}

Move twisted(double angle) {
  return [angle](const Vec3& p) {
    const double turn = angle * p.z / 4, c = std::cos(turn), s = std::sin(turn);
    return Vec3{c * p.x - s * p.y, s * p.x + c * p.y, p.z};
  };
}

StepFit fitted(const BoundaryPair& pair, double tolerance) {
  return fitInSteps(pair, pointsInside(pair.solid(), 2000), {.tolerance = tolerance});
}

class Stages : public RunContext {
 public:
  void report(std::string_view stage, double) override {
    const std::lock_guard lock(mutex_);
    seen.emplace(stage);
  }

  std::set<std::string> seen;

 private:
  std::mutex mutex_;
};

// Over the target's diagonal.
std::vector<double> errorsAt(const StepFit& fit, const BoundaryPair& pair, const Points& points,
                             const std::function<Vec3(std::size_t)>& exact) {
  const Matrix values = fit.map.evaluate(points).values;
  std::vector<double> out;
  for (std::size_t i = 0; i < points.size(); ++i)
    out.push_back(norm(Vec3{values(i, 0), values(i, 1), values(i, 2)} - exact(i)) /
                  pair.target.diagonal);
  return out;
}

// What the whole solid turns, moves and grows is no part of the way: every step should stay where
// it is, and what they compose to is known inside. It is nowhere farther from that than the
// boundary and, by the maximum principle in the second step's solid, twice the first step's error.
TEST(StepFitRelease, SimilaritiesAreMetInside) {
  const Mesh source = plainBar();
  for (const auto& [tolerance, up] : {std::pair{1e-3, 3}, {1e-5, 3}, {1e-3, -3}}) {  // -: mirrored
    const Move map = [up = up](const Vec3& p) { return Vec3{2 - 3 * p.y, 3 * p.x + 1, up * p.z}; };
    const BoundaryPair pair = makeBoundaryPair(source, moved(source, map));
    const StepFit fit = fitted(pair, tolerance);
    ASSERT_EQ(fit.steps.size(), 2u);
    const Points inside = pointsInside(pair.solid(), 3000);
    const std::vector<double> errors =
        errorsAt(fit, pair, inside, [&](std::size_t i) { return map(inside[i]); });
    EXPECT_LT(*std::max_element(errors.begin(), errors.end()),
              fit.error.max + 2 * fit.steps[0].error);
    EXPECT_LE(fit.error.p99, tolerance);
  }
}

// The certificate is of 20,000 random points of the surface. Of `count` others, drawn alike, how
// many lie beyond one of its quantiles does not depend on the map: of the largest n + m values, n
// of the certificate's, each is as likely to be any point. Beyond the 200th largest are
// 200 m / n of them on average, with a variance of 200 (m / n) (1 + m / n); that 8 or more lie
// beyond the largest has the probability (m / (m + n))^8.
TEST(StepFitRelease, ErrorsElsewhereAreThoseOfTheCertificate) {
  constexpr double kOthers = 5000, kShare = kOthers / kFreshSamples, kBeyond = 0.01 * kFreshSamples;
  const double mean = kBeyond * kShare, deviation = std::sqrt(mean * (1 + kShare));
  struct Case {
    Mesh source;
    Move map;
    double tolerance;
  };
  for (const Case& c : {Case{plainBar(), bent(2.5), 2e-3}, Case{plainBar(), twisted(2), 2e-3},
                        Case{ball(4),
                             [](const Vec3& p) {
                               const double angle = std::acos(std::clamp(p.z, -1.0, 1.0));
                               return p - Vec3{0, 0, 0.85 * std::exp(-angle * angle / 0.36)};
                             },
                             4e-3}}) {
    const BoundaryPair pair = makeBoundaryPair(c.source, moved(c.source, c.map));
    const StepFit fit = fitted(pair, c.tolerance);
    const std::vector<SurfacePoint> places =
        randomSamples(pair.solid().surface(), static_cast<std::size_t>(kOthers), {.seed = 7777});
    const Points points = interpolate(c.source.vertices, c.source.triangles, places),
                 targets = interpolate(pair.target.moved, c.source.triangles, places);
    const std::vector<double> errors =
        errorsAt(fit, pair, points, [&](std::size_t i) { return targets[i]; });
    const auto beyond = [&](double limit) {
      return static_cast<double>(
          std::count_if(errors.begin(), errors.end(), [&](double e) { return e > limit; }));
    };
    EXPECT_NEAR(beyond(fit.error.p99), mean, 5 * deviation);
    EXPECT_LT(beyond(fit.error.max), 8);
    EXPECT_LE(fit.error.p99, c.tolerance);
  }
}

// Errors are fractions of the target's diagonal however it is turned: its box changes with that,
// and steps are fitted to a shape that lies as the source does.
TEST(StepFit, TheUnitIsTheTargetsDiagonal) {
  const Mesh source = moved(ball(3), [](const Vec3& p) {  // nearly a cube
    return p / std::pow(std::pow(p.x, 6) + std::pow(p.y, 6) + std::pow(p.z, 6), 1.0 / 6);
  });
  const BoundaryPair pair =
      makeBoundaryPair(source, moved(source, [](const Vec3& p) {
                         const Vec3 q{p.x + 0.2 * p.y * p.y, p.y, p.z};
                         return Vec3{q.x - q.y, q.x + q.y, std::sqrt(2) * q.z};
                       }));
  const StepFit fit = fitted(pair, 5e-3);
  const std::vector<SurfacePoint> places =
      randomSamples(pair.solid().surface(), kFreshSamples,
                    {.seed = seedOf(StepFitSettings{}.seed, Stream::fresh)});
  const Points targets = interpolate(pair.target.moved, source.triangles, places);
  const BoundaryError again =
      summarizeErrors(errorsAt(fit, pair, interpolate(source.vertices, source.triangles, places),
                               [&](std::size_t i) { return targets[i]; }));
  constexpr double kSums = 3e-6;  // of images, of the diagonal; another unit is a tenth off
  EXPECT_NEAR(again.p99, fit.error.p99, kSums);
  EXPECT_NEAR(again.rms, fit.error.rms, kSums);
  EXPECT_NEAR(again.max, fit.error.max, kSums);
}

// What the composed map should be is not known of a bend, but a fit ten times as exact is nearer to
// it: inside, they differ by no more than both say of their boundary.
TEST(StepFitRelease, InsideErrorsAreBelowTheCertificates) {
  const Mesh source = plainBar();
  for (const Move& map : {bent(2.5), twisted(2)}) {
    const BoundaryPair pair = makeBoundaryPair(source, moved(source, map));
    const StepFit coarse = fitted(pair, 5e-3), fine = fitted(pair, 1e-3);
    ASSERT_EQ(coarse.steps.size(), fine.steps.size());
    const Points inside = pointsInside(pair.solid(), 3000);
    std::vector<double> errors =
        errorsAt(coarse, pair, inside, [&](std::size_t i) { return fine.map(inside[i]); });
    std::sort(errors.begin(), errors.end());
    EXPECT_LT(errors[errors.size() * 99 / 100], coarse.error.p99 + fine.error.p99);
    EXPECT_LT(errors.back(), coarse.error.max + fine.error.max);
  }
}

// So few charges cannot follow a bar that is wrung: once the errors add up to eight times the
// tolerance, one step does the rest of the way, where too few are allowed for a detour.
TEST(StepFitRelease, OneStepDoesTheRestOfAWayThatIsLost) {
  constexpr double kTolerance = 3e-4;
  const Mesh source = plainBar();
  const BoundaryPair pair = makeBoundaryPair(source, moved(source, twisted(12)));
  const StepFit fit =
      fitInSteps(pair, pointsInside(pair.solid(), 2000),
                 {.tolerance = kTolerance, .folds = 4e-4, .maxSteps = 11, .maxSources = 1000});
  double missed = 0;
  std::size_t lost = 0;
  while (lost < fit.steps.size() && missed <= 8 * kTolerance) missed += fit.steps[lost++].error;
  ASSERT_LT(lost, fit.steps.size()) << "it was to be lost on the way";
  EXPECT_EQ(fit.steps.size(), lost + 1);
  EXPECT_EQ(fit.steps.back().to, 1);
}

// In between the limb is a disc that runs through the body, where nothing can be fitted.
TEST(StepFitRelease, ALimbIsTurnedIntoAPit) {
  const BoundaryPair pair = makeBoundaryPair(drawnOut(1.5), drawnOut(-1));
  Stages run;
  const RunScope scope(run);
  const StepFit fit =
      fitInSteps(pair, pointsInside(pair.solid(), 2000), {.tolerance = 1e-2, .folds = 1e-3});
  EXPECT_EQ(run.seen.count("going by smoothed shapes"), 1);
  EXPECT_LE(fit.error.p99, 1e-2);
  EXPECT_LE(fit.steps.back().folded, 1e-3);
}

// However many steps are allowed.
TEST(StepFitRelease, OneStepDoesTheRestOnceTheChargesOfAWayAreSpent) {
  constexpr double kWaySources = 4000;
  const BoundaryPair pair = makeBoundaryPair(drawnOut(1.5), drawnOut(-1));
  const StepFit fit = fitInSteps(pair, pointsInside(pair.solid(), 2000),
                                 {.tolerance = 1e-2, .folds = 1e-3, .waySources = kWaySources});
  ASSERT_GT(fit.steps.size(), 1);
  EXPECT_EQ(fit.steps.back().to, 1);
  double before = 0;  // the last two: that which takes more than is left, and the rest
  for (std::size_t s = 0; s + 2 < fit.steps.size(); ++s)
    before += static_cast<double>(fit.steps[s].sources);
  EXPECT_LE(before, kWaySources);
  EXPECT_GT(fit.steps.back().folded, 1e-3) << "the way was not cut short";
}

// Limbs and pits take more steps by the detour than are allowed here.
TEST(StepFitRelease, FewStepsMakeNoDetour) {
  const BoundaryPair pair = makeBoundaryPair(drawnOut(1.5), drawnOut(-1));
  Stages run;
  const RunScope scope(run);
  const StepFit fit = fitInSteps(pair, pointsInside(pair.solid(), 2000),
                                 {.tolerance = 1e-2, .folds = 1e-3, .maxSteps = 3});
  EXPECT_EQ(run.seen.count("going by smoothed shapes"), 0);
  EXPECT_LE(fit.steps.size(), 3);
}

// Central differences at two distances: what they are off falls with the square.
TEST(StepFit, JacobiansAreTheDerivative) {
  const Mesh source = plainBar();
  const BoundaryPair pair = makeBoundaryPair(source, moved(source, bent(2.5)));
  const StepFit fit = fitted(pair, 4e-3);
  const Points inside = pointsInside(pair.solid(), 200);
  double largest = 0;
  for (const Vec3& p : inside) {
    if (pair.solid().distance(p) < 0.1) continue;
    const Mat3 j = fit.map.jacobian(p);
    for (int a = 0; a < 3; ++a) {
      const auto slope = [&](double h) {
        Vec3 step;
        step[a] = h;
        return (fit.map(p + step) - fit.map(p - step)) / (2 * h);
      };
      const Vec3 better = (4.0 * slope(5e-4) - slope(1e-3)) / 3;
      for (int r = 0; r < 3; ++r)
        largest = std::max(
            largest,
            std::abs(j[static_cast<std::size_t>(r)][static_cast<std::size_t>(a)] - better[r]));
    }
  }
  EXPECT_LT(largest, 1e-9);
}

TEST(StepFitRelease, SameForAnyNumberOfThreads) {
  const Mesh source = plainBar();
  const BoundaryPair pair = makeBoundaryPair(source, moved(source, bent(1)));
  const auto at = [&](int threads) {
    const ThreadLimit limit(threads);
    return fitted(pair, 1e-2).map({0.1, 0.2, 0.3});
  };
  EXPECT_EQ(norm(at(1) - at(3)), 0);
}

}  // namespace
}  // namespace innermap
