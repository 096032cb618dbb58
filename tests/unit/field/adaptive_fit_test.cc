#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <iterator>
#include <set>

#include "core/expect.h"
#include "core/pi.h"
#include "core/point_grid.h"
#include "field/sphere_problem.h"
#include "innermap/core/error.h"
#include "innermap/core/memory.h"
#include "innermap/core/run.h"
#include "innermap/field/fit.h"

namespace innermap {
namespace {

constexpr double kDiagonal = 3.4641016151377544;

// Smooth, but for a kink that is sharp near (1, 0, 0) and fades away from it.
Matrix kinkedValues(const Points& points) {
  Matrix v = testing::harmonicMapValues(points);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3& p = points[i];
    v(i, 0) += 0.3 * std::abs(p.y) * std::exp(-8 * squaredNorm(p - Vec3{1, 0, 0}));
  }
  return v;
}

Points onSphere(std::size_t count, std::uint64_t seed) {
  Points points = testing::randomPoints(count, seed);
  for (Vec3& p : points) p = p / norm(p);
  return points;
}

Points darts(const PlacementRequest& request, double radius) {
  PointGrid taken(request.existing, request.spacing * kDiagonal),
      marks(request.marks, 2 * request.reach * kDiagonal);
  Points out;
  const double area = 4 * kPi / std::pow(request.spacing * kDiagonal, 2);
  for (const Vec3& p : onSphere(static_cast<std::size_t>(12 * area) + 50, 100 + request.index)) {
    const Vec3 q = radius * p;
    if (!request.marks.empty() && !marks.anyNearer(p, request.reach * kDiagonal) &&
        !marks.anyNearer(q, request.reach * kDiagonal))
      continue;
    if (out.size() == request.most || taken.anyNearer(q, request.spacing * kDiagonal)) continue;
    taken.add(q);
    out.push_back(q);
  }
  return out;
}

struct Ball {
  std::vector<double> distances;  // asked for
  AdaptiveProblem problem;
  AdaptiveSettings settings;

  Ball() {
    problem.diagonal = problem.unit = kDiagonal;
    problem.area = 4 * kPi;
    problem.draw = [](std::size_t count, std::uint64_t draw) {
      const Points points = onSphere(count, 7 + draw);
      return BoundarySamples{points, kinkedValues(points)};
    };
    problem.placeSources = [this](const PlacementRequest& request, double distance) {
      distances.push_back(distance);
      return darts(request, 1 + distance * kDiagonal);
    };
    problem.placeCollocation = [](const PlacementRequest& request) {
      const Points points = darts(request, 1);
      return BoundarySamples{points, kinkedValues(points)};
    };
    settings.firstSources = 150;
  }
};

TEST(AdaptiveFitRelease, MeetsTheToleranceWithChargesWhereTheKinkIs) {
  Ball ball;
  ball.settings.tolerance = 2e-4;
  const AdaptiveResult r = fitToTolerance(ball.problem, ball.settings);
  EXPECT_EQ(r.end, AdaptiveEnd::met);
  EXPECT_LE(r.error.p99, ball.settings.tolerance);
  EXPECT_LT(r.error.max, 20 * r.error.rms);
  EXPECT_EQ(r.error.samples, ball.settings.checkSamples);
  // Of what no part of the fit saw.
  const Points fresh = onSphere(20000, 999);
  EXPECT_LT(measureBoundaryError(r.field, fresh, kinkedValues(fresh), kDiagonal).p99,
            1.1 * ball.settings.tolerance);
  ASSERT_GE(r.levels.size(), 3u);
  std::size_t count = 0, near = 0;
  for (const AdaptiveLevel& l : r.levels) count += l.sources;
  EXPECT_EQ(count, r.field.sources().size());
  for (std::size_t l = 1; l < r.levels.size(); ++l)
    EXPECT_NEAR(r.levels[l].distance, 0.5 * r.levels[l - 1].distance, 1e-12);
  // The finest level: where x is over 0.4, which is three tenths of the sphere.
  std::size_t finest = 0;
  for (const Vec3& q : r.field.sources()) {
    if (norm(q) > 1 + 1.1 * r.levels.back().distance * kDiagonal) continue;
    ++finest;
    if (q.x > 0.4 * norm(q)) ++near;
  }
  EXPECT_EQ(finest, r.levels.back().sources);
  EXPECT_GT(near, 0.9 * static_cast<double>(finest));
}

TEST(AdaptiveFit, EndsWhereTheBoundaryHasNoRoomForPoints) {
  Ball ball;
  ball.settings.tolerance = 2e-4;
  ball.problem.placeCollocation = [](const PlacementRequest& request) {
    const Points points = request.marks.empty() ? darts(request, 1) : Points();
    return BoundarySamples{points, kinkedValues(points)};
  };
  const AdaptiveResult r = fitToTolerance(ball.problem, ball.settings);
  EXPECT_EQ(r.end, AdaptiveEnd::noGain);
  EXPECT_LE(r.field.sources().size(), r.collocation);
}

TEST(AdaptiveFit, SmoothValuesNeedOnlyTheFirstLevel) {
  Ball ball;
  ball.settings.tolerance = 2e-2;
  const AdaptiveResult r = fitToTolerance(ball.problem, ball.settings);
  EXPECT_EQ(r.end, AdaptiveEnd::met);
  EXPECT_EQ(r.rounds.size(), 1u);
  EXPECT_EQ(ball.distances.size(), 1u);
}

TEST(AdaptiveFit, SaysWhichLimitItReached) {
  Ball ball;
  ball.settings.tolerance = 1e-5;
  ball.settings.maxSources = 400;
  AdaptiveResult r = fitToTolerance(ball.problem, ball.settings);
  EXPECT_EQ(r.end, AdaptiveEnd::maxSources);
  EXPECT_LE(r.field.sources().size(), 400u);
  EXPECT_GT(r.error.p99, ball.settings.tolerance);
  ball.settings.maxSources = 100000;
  {
    const std::uint64_t many = std::uint64_t(1) << 62, held = processMemory(many) - many;
    const MemoryLimit limit(held + 9'000'000);
    r = fitToTolerance(ball.problem, ball.settings);
  }
  EXPECT_EQ(r.end, AdaptiveEnd::maxMemory);
  test::expectOverLimit(1000, [&] { fitToTolerance(ball.problem, ball.settings); });
}

TEST(AdaptiveFitRelease, EndsWhereItIsToldToAfterAnyRound) {
  Ball ball;
  ball.settings.tolerance = 2e-4;
  int asked = 0, last = 1000;
  ball.settings.goOn = [&](const HarmonicField& field, int round) {
    EXPECT_EQ(round, ++asked);
    EXPECT_TRUE(round > 1 || field.sources().size() < 2 * ball.settings.firstSources);
    return round < last;
  };
  const AdaptiveResult whole = fitToTolerance(ball.problem, ball.settings);
  EXPECT_EQ(whole.end, AdaptiveEnd::met);
  EXPECT_EQ(asked, static_cast<int>(whole.rounds.size()));
  ASSERT_GT(asked, 2);
  for (last = 1; last <= 2; ++last) {
    asked = 0;
    const AdaptiveResult r = fitToTolerance(ball.problem, ball.settings);
    EXPECT_EQ(r.end, AdaptiveEnd::stopped);
    EXPECT_EQ(r.rounds.size(), static_cast<std::size_t>(last));
    EXPECT_EQ(r.levels.size(), static_cast<std::size_t>(last));
  }
}

TEST(AdaptiveFit, EndsAtTheDeadlineWithWhatThereIs) {
  Ball ball;
  ball.settings.tolerance = 2e-4;
  RunContext late;
  late.setSecondsLeft(0);
  const RunScope scope(late);
  const AdaptiveResult r = fitToTolerance(ball.problem, ball.settings);
  EXPECT_EQ(r.end, AdaptiveEnd::time);
  EXPECT_EQ(r.rounds.size(), 1u);
  EXPECT_GT(r.error.p99, ball.settings.tolerance);
  EXPECT_TRUE(late.endedByTime());
}

TEST(AdaptiveFit, NoRoomForFinerLevelsIsNoGain) {
  Ball ball;
  ball.settings.tolerance = 1e-4;
  const auto place = ball.problem.placeSources;
  const AdaptiveProblem& problem = ball.problem;
  ball.problem.placeSources = [&, place](const PlacementRequest& request, double distance) {
    return request.marks.empty() ? place(request, distance) : Points();
  };
  EXPECT_EQ(fitToTolerance(problem, ball.settings).end, AdaptiveEnd::noGain);
}

// A level that finds no room in a gap is passed over, and the next one tried.
TEST(AdaptiveFitRelease, GoesOnBelowALevelWithoutRoom) {
  Ball ball;
  ball.settings.tolerance = 4e-4;
  const auto place = ball.problem.placeSources;
  double second = 0;
  ball.problem.placeSources = [&, place](const PlacementRequest& request, double distance) {
    if (!request.marks.empty() && second == 0) second = distance;
    return distance == second ? Points() : place(request, distance);
  };
  const AdaptiveResult r = fitToTolerance(ball.problem, ball.settings);
  ASSERT_GE(r.levels.size(), 3u);
  EXPECT_EQ(r.levels[1].sources, 0u);
  EXPECT_GT(r.levels[2].sources, 0u);
  EXPECT_EQ(r.end, AdaptiveEnd::met);
}

// Where a level has no room about some of its marks, the next one is tried there, in the same
// round, as far as finer levels have been tried.
TEST(AdaptiveFitRelease, GoesOnBelowALevelWhereThatHasNoRoom) {
  constexpr std::size_t kNarrow = 3;  // the level without room where x is positive
  struct Request {
    std::size_t level;
    Points marks;
  };
  Ball ball;
  ball.settings.tolerance = 1e-4;
  std::vector<std::vector<Request>> rounds;
  const auto draw = ball.problem.draw;
  ball.problem.draw = [&](std::size_t count, std::uint64_t index) {
    rounds.emplace_back();
    return draw(count, index);
  };
  std::set<double, std::greater<>> distances;
  const auto place = ball.problem.placeSources;
  ball.problem.placeSources = [&](const PlacementRequest& request, double distance) {
    distances.insert(distance);
    const auto level =
        static_cast<std::size_t>(std::distance(distances.begin(), distances.find(distance)));
    if (level > 0) rounds.back().push_back({level, request.marks});
    Points there = place(request, distance);
    const auto narrow = [&](const Vec3& q) { return level == kNarrow && q.x > 0; };
    there.erase(std::remove_if(there.begin(), there.end(), narrow), there.end());
    return there;
  };
  EXPECT_EQ(fitToTolerance(ball.problem, ball.settings).end, AdaptiveEnd::met);
  std::size_t seen = 0, finest = 0;
  for (const std::vector<Request>& round : rounds)
    for (std::size_t i = 0; i < round.size(); ++i) {
      const std::size_t before = finest;
      finest = std::max(finest, round[i].level);
      if (round[i].level != kNarrow || before <= kNarrow) continue;
      ASSERT_LT(i + 1, round.size());
      ASSERT_EQ(round[i + 1].level, kNarrow + 1);
      const Points& next = round[i + 1].marks;
      for (const Vec3& p : round[i].marks) {
        if (p.x < 0.1) continue;  // charges at x below 0 may be near
        ++seen;
        EXPECT_TRUE(std::any_of(next.begin(), next.end(),
                                [&](const Vec3& q) { return norm(p - q) < 1e-12; }))
            << p.x << " " << p.y << " " << p.z;
      }
    }
  EXPECT_GT(seen, 0u);
}

// A fiftieth of the sphere is met by no level before the fourth, so that the error at 99% stays,
// while waves elsewhere take ten times the first charges.
TEST(AdaptiveFit, GoesOnUntilChargesAreAsFineAsASmallPart) {
  const auto waves = [](const Points& points) {
    Matrix v = testing::harmonicMapValues(points);
    for (std::size_t i = 0; i < points.size(); ++i) v(i, 0) += 0.035 * std::sin(20 * points[i].x);
    return v;
  };
  Ball ball;
  ball.problem.placeCollocation = [&](const PlacementRequest& request) {
    const Points points = darts(request, 1);
    return BoundarySamples{points, waves(points)};
  };
  ball.problem.draw = [&](std::size_t count, std::uint64_t draw) {
    const std::vector<double>& tried = ball.distances;
    const bool fine = *std::min_element(tried.begin(), tried.end()) < tried.front() / 7;
    const Points points = onSphere(count, 7 + draw);
    Matrix values = waves(points);
    for (std::size_t i = 0; i < points.size(); ++i)
      if (!fine && points[i].x > 0.96) values(i, 1) += 0.5;
    return BoundarySamples{points, std::move(values)};
  };
  ball.settings.firstSources = 40;
  ball.settings.tolerance = 7e-3;
  ball.settings.outlierRounds = 0;
  const AdaptiveResult r = fitToTolerance(ball.problem, ball.settings);
  EXPECT_EQ(r.end, AdaptiveEnd::met);
  ASSERT_GE(r.rounds.size(), 4u);
  EXPECT_GT(r.rounds[2].error.p99, 0.97 * r.rounds[0].error.p99);
  EXPECT_GT(r.rounds[2].sources, 4 * r.rounds[0].sources);
}

// Quarters are moved along each other: no charges meet that, and finer ones about the lines between
// them are no better.
TEST(AdaptiveFitRelease, DoesNotChaseJumps) {
  const auto split = [](const Points& points) {
    Matrix v = testing::harmonicMapValues(points);
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (points[i].y > 0) v(i, 0) += 0.1;
      if (points[i].x > 0) v(i, 1) += 0.1;
    }
    return v;
  };
  Ball ball;
  ball.problem.draw = [&](std::size_t count, std::uint64_t draw) {
    const Points points = onSphere(count, 7 + draw);
    return BoundarySamples{points, split(points)};
  };
  ball.problem.placeCollocation = [&](const PlacementRequest& request) {
    const Points points = darts(request, 1);
    return BoundarySamples{points, split(points)};
  };
  ball.settings.tolerance = 4e-3;
  ball.settings.maxSources = 5000;
  for (int k = 0; k < 1000; ++k) {
    const double a = std::cos(2 * kPi * k / 1000), b = std::sin(2 * kPi * k / 1000);
    ball.problem.jumps.push_back({a, 0, b});
    ball.problem.jumps.push_back({0, a, b});
  }
  const AdaptiveResult known = fitToTolerance(ball.problem, ball.settings);
  EXPECT_EQ(known.end, AdaptiveEnd::jumps);
  EXPECT_GT(known.error.p99, ball.settings.tolerance);
  EXPECT_LT(known.rounds.back().error.p99, ball.settings.tolerance);
  // Beyond some spacings of the third level the jump is not felt.
  const double spacing = std::sqrt(4 * kPi / 150) / 4;
  Points away;
  for (const Vec3& p : onSphere(20000, 999))
    if (std::min(std::abs(p.x), std::abs(p.y)) > 3 * spacing) away.push_back(p);
  EXPECT_LT(measureBoundaryError(known.field, away, split(away), kDiagonal).p99,
            ball.settings.tolerance);
  ball.problem.jumps.clear();
  const AdaptiveResult unknown = fitToTolerance(ball.problem, ball.settings);
  EXPECT_LT(2 * known.field.sources().size(), unknown.field.sources().size());
}

TEST(AdaptiveFit, RefusesBadSettings) {
  for (const double tolerance : {0.0, -1.0, 1e-13, 2.0, std::nan("")}) {
    Ball ball;
    ball.settings.tolerance = tolerance;
    EXPECT_THROW(fitToTolerance(ball.problem, ball.settings), SettingError) << tolerance;
  }
  Ball ball;
  ball.settings.maxSources = 10;
  EXPECT_THROW(fitToTolerance(ball.problem, ball.settings), SettingError);
  ball.settings = {};
  ball.settings.firstSources = 1;
  EXPECT_THROW(fitToTolerance(ball.problem, ball.settings), SettingError);
  ball.settings = {};
  ball.problem.area = 0;
  EXPECT_THROW(fitToTolerance(ball.problem, ball.settings), DataError);
}

}  // namespace
}  // namespace innermap
