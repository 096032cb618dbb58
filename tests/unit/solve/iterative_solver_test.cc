#include <gtest/gtest.h>

#include "core/expect.h"
#include "core/pi.h"
#include "core/random.h"
#include "innermap/core/error.h"
#include "innermap/core/run.h"
#include "innermap/solve/kernel_sum.h"
#include "innermap/solve/solver.h"
#include "solve/points.h"

namespace innermap {
namespace {

using testing::spherePoints;

struct IterativeProblem {
  double spacing = std::sqrt(4 * kPi / 1200), distance = 1.25 * spacing;
  Points collocation = spherePoints(3600, 1), fresh = spherePoints(4000, 1, 0.4);
  SourceLevel coarse{spherePoints(150, 1.4, 2), std::sqrt(4 * kPi / 150), 0.4},
      fine{spherePoints(1200, 1 + distance, 1), spacing, distance};

  IterativeSolver solver(const IterativeSettings& s = {}) const {
    return IterativeSolver(collocation, {coarse, fine}, s);
  }
};

// Kinks about as far apart as the sources resolve, and a smooth part.
Matrix roughValues(const Points& points) {
  Matrix v(points.size(), 2);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3& p = points[i];
    v(i, 0) = std::abs(std::sin(4 * p.x)) + p.y * p.z;
    v(i, 1) = 5 + p.x + std::abs(p.z);
  }
  return v;
}

template <class Solution>
double rmsError(const Solution& s, const Points& sources, const Points& points) {
  const Matrix wanted = roughValues(points),
               sums = sumCharges(Charges(sources, s.weights), points, false).values;
  double square = 0;
  for (std::size_t k = 0; k < wanted.columns(); ++k)
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double e = sums(i, k) + s.affine.value(points[i], k) - wanted(i, k);
      square += e * e;
    }
  return std::sqrt(square / static_cast<double>(points.size()));
}

TEST(IterativeSolver, IsAsGoodAsTheDenseSolver) {
  const IterativeProblem p;
  const IterativeSolver solver = p.solver();
  const IterativeSolution fast = solver.solve(roughValues(p.collocation));
  const DenseSolution dense =
      DenseSolver(p.collocation, p.fine.sources, p.fresh)
          .solve(roughValues(p.collocation), Regularization::tikhonov, roughValues(p.fresh));
  EXPECT_LT(rmsError(fast, solver.sources(), p.fresh),
            1.1 * rmsError(dense, p.fine.sources, p.fresh));
  EXPECT_LE(fast.iterations, 5);
}

TEST(IterativeSolver, ResidualsAreTrueAndFall) {
  const IterativeProblem p;
  const IterativeSolver solver = p.solver();
  const IterativeSolution s = solver.solve(roughValues(p.collocation));
  ASSERT_EQ(s.residuals.size(), static_cast<std::size_t>(s.iterations) + 1);
  for (std::size_t i = 1; i < s.residuals.size(); ++i)
    EXPECT_LE(s.residuals[i], s.residuals[i - 1]);
  EXPECT_NEAR(rmsError(s, solver.sources(), p.collocation), s.residuals.back(), 1e-9);
}

// Three channels that look alike on a ball.
TEST(IterativeSolver, AffineDataAreExact) {
  const IterativeProblem p;
  Matrix b(p.collocation.size(), 3);
  for (std::size_t i = 0; i < b.rows(); ++i) {
    const Vec3& at = p.collocation[i];
    b(i, 0) = 3 + at.x - 2 * at.z;
    b(i, 1) = at.y + 1e-5 * at.x;
    b(i, 2) = at.z;
  }
  const IterativeSolution s = p.solver().solve(b);
  EXPECT_LT(s.residuals.back(), 1e-14);
  EXPECT_EQ(s.iterations, 0);
}

TEST(IterativeSolver, SameBitsForAnyNumberOfThreads) {
  const IterativeProblem p;
  const auto weights = [&] { return p.solver().solve(roughValues(p.collocation)).weights; };
  const Matrix all = weights();
  const ThreadLimit one(1);
  const Matrix single = weights();
  EXPECT_TRUE(std::equal(all.data(), all.data() + 2 * 1350, single.data()));
}

TEST(IterativeSolver, ScaleAndPlaceDoNotMatter) {
  const IterativeProblem p;
  const auto moved = [](Points q) {
    for (Vec3& v : q) v = 1e-3 * v + Vec3{4, 5, 6};
    return q;
  };
  const auto movedLevel = [&](const SourceLevel& l) {
    return SourceLevel{moved(l.sources), 1e-3 * l.spacing, 1e-3 * l.distance};
  };
  const Matrix b = roughValues(p.collocation);
  const auto one = p.solver().solve(b);
  const auto two =
      IterativeSolver(moved(p.collocation), {movedLevel(p.coarse), movedLevel(p.fine)}).solve(b);
  EXPECT_EQ(one.iterations, two.iterations);
  EXPECT_NEAR(one.residuals.back() / two.residuals.back(), 1, 1e-3);
}

// Random right-hand sides: nothing that a field of this size could be. The residual must come down
// to the dense one all the same.
TEST(IterativeSolver, ReachesTheDenseResidualOnSmallProblems) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const CounterRandom random(seed, 9);
    const std::size_t count = 40 + random.bits(0) % 200;
    const double h = std::sqrt(4 * kPi / static_cast<double>(count));
    const Points collocation = spherePoints(4 * count, 1, random.uniform(1)),
                 fine = spherePoints(count, 1 + 1.25 * h, random.uniform(2)),
                 coarse = spherePoints(count / 4, 1 + 2.5 * h);
    Matrix b(collocation.size(), 2);
    for (std::size_t i = 0; i < 2 * collocation.size(); ++i)
      b.data()[i] = random.uniform(10 + i) - 0.5;
    const IterativeSolver solver(collocation, {{coarse, 2 * h, 2.5 * h}, {fine, h, 1.25 * h}},
                                 {.maxIterations = 30});
    const IterativeSolution fast = solver.solve(b);
    const DenseSolution dense =
        DenseSolver(collocation, solver.sources(), {}).solve(b, Regularization::tikhonov, {}, 1e-3);
    const auto residual = [&](const Matrix& weights, const Affine& affine) {
      const Matrix sums = sumCharges(Charges(solver.sources(), weights), collocation, false).values;
      double square = 0;
      for (std::size_t k = 0; k < 2; ++k)
        for (std::size_t i = 0; i < b.rows(); ++i)
          square += std::pow(b(i, k) - sums(i, k) - affine.value(collocation[i], k), 2);
      return std::sqrt(square / static_cast<double>(b.rows()));
    };
    EXPECT_NEAR(residual(fast.weights, fast.affine), fast.residuals.back(), 1e-9);
    EXPECT_LT(fast.residuals.back(), 1.05 * residual(dense.weights, dense.affine));
  }
}

// The fine level in two parts, one of them added later: another preconditioner, the same problem.
TEST(IterativeSolver, GrowsAndStartsWarm) {
  const IterativeProblem p;
  const Matrix values = roughValues(p.collocation);
  SourceLevel left{{}, p.spacing, p.distance}, right = left;
  for (const Vec3& q : p.fine.sources) (q.x < 0 ? left : right).sources.push_back(q);
  Points first, second;
  for (std::size_t i = 0; i < p.collocation.size(); ++i)
    (i % 3 > 0 ? first : second).push_back(p.collocation[i]);
  IterativeSolver grown(first, {p.coarse, left});
  const IterativeSolution before = grown.solve(roughValues(first));
  grown.add(second, {right});
  EXPECT_EQ(grown.sources().size(), 1350u);
  EXPECT_EQ(grown.collocation(), p.collocation.size());
  Points all = first;
  all.insert(all.end(), second.begin(), second.end());
  const Matrix allValues = roughValues(all);
  const IterativeSolution warm = grown.solve(allValues, &before), cold = grown.solve(allValues);
  EXPECT_LT(warm.residuals.front(), 0.3 * cold.residuals.front());
  const IterativeSolution whole = p.solver().solve(values);
  EXPECT_LT(warm.residuals.back(), 1.1 * whole.residuals.back());
  EXPECT_LT(rmsError(warm, grown.sources(), p.fresh),
            1.1 * rmsError(whole, p.solver().sources(), p.fresh));
  EXPECT_NEAR(rmsError(warm, grown.sources(), all), warm.residuals.back(), 1e-9);
  EXPECT_THROW(grown.solve(roughValues(first)), DataError);
  EXPECT_THROW(IterativeSolver(p.collocation, {p.coarse}).solve(values, &warm), DataError);
}

// A handful about one place: there the residual falls, and the other charges stay as they are.
TEST(IterativeSolver, FewAddedChargesAreSolvedForAlone) {
  const IterativeProblem p;
  IterativeSolver solver = p.solver();
  const Vec3 place{1, 0, 0};
  const IterativeSolution before = solver.solve(roughValues(p.collocation));
  const auto near = [&](const Points& points, double reach) {
    Points out;
    for (const Vec3& q : points)
      if (norm(q / norm(q) - place) < reach) out.push_back(q);
    return out;
  };
  const double half = 0.5 * p.spacing;
  const SourceLevel finer{near(spherePoints(4800, 1 + half, 3), 1.3 * p.spacing), half, half};
  const Points added = near(spherePoints(20000, 1, 0.7), 2 * p.spacing);
  ASSERT_LE(50 * finer.sources.size(), solver.sources().size());
  ASSERT_GT(added.size(), 2 * finer.sources.size());
  solver.add(added, {finer});
  Points all = p.collocation;
  all.insert(all.end(), added.begin(), added.end());
  const IterativeSolution after = solver.solve(roughValues(all), &before);
  ASSERT_EQ(after.residuals.size(), static_cast<std::size_t>(after.iterations) + 1);
  EXPECT_NEAR(rmsError(after, solver.sources(), all), after.residuals.back(), 1e-9);
  EXPECT_LT(rmsError(after, solver.sources(), added),
            0.8 * rmsError(before, p.solver().sources(), added));
  for (std::size_t k = 0; k < 2; ++k)
    for (std::size_t j = 0; j < before.weights.rows(); ++j)
      EXPECT_NEAR(after.weights(j, k), before.weights(j, k), 1e-9 * before.weightNorm);
}

TEST(IterativeSolver, OneLevelIsEnough) {
  const IterativeProblem p;
  const IterativeSolver solver(p.collocation, {p.coarse});
  const IterativeSolution s = solver.solve(roughValues(p.collocation));
  const DenseSolution dense =
      DenseSolver(p.collocation, p.coarse.sources, p.fresh)
          .solve(roughValues(p.collocation), Regularization::tikhonov, roughValues(p.fresh));
  // It sees 4 points a charge of the 24 that the dense solver has.
  EXPECT_LT(rmsError(s, solver.sources(), p.fresh),
            1.2 * rmsError(dense, p.coarse.sources, p.fresh));
}

TEST(IterativeSolver, RefusesWhatCannotBe) {
  IterativeProblem p;
  test::expectOverLimit(10000, [&] { p.solver({}); });
  EXPECT_THROW(IterativeSolver(p.collocation, {}), SettingError);
  EXPECT_THROW(IterativeSolver(p.collocation, {p.coarse, {{}, 1, 1}}), SettingError);
  EXPECT_THROW(IterativeSolver(p.coarse.sources, {p.coarse, p.fine}), SettingError);
  test::expectCancels([&] { p.solver({}); });
  p.fine.spacing = 0;
  EXPECT_THROW(p.solver(), SettingError);
}

}  // namespace
}  // namespace innermap
