#include "innermap/solve/iterative_solver.h"

#include <gtest/gtest.h>

#include "innermap/core/error.h"
#include "innermap/core/parallel.h"
#include "innermap/solve/dense_solver.h"
#include "innermap/solve/kernel_sum.h"
#include "solve/points.h"

namespace innermap {
namespace {

using testing::spherePoints;

struct Problem {
  double spacing = std::sqrt(4 * M_PI / 1200), distance = 1.25 * spacing;
  Points collocation = spherePoints(3600, 1), sources = spherePoints(1200, 1 + distance, 1),
         coarse = spherePoints(150, 1.4, 2), fresh = spherePoints(4000, 1, 0.4);

  IterativeSettings settings() const {
    IterativeSettings s;
    s.spacing = spacing;
    s.distance = distance;
    return s;
  }
  Points all() const {
    Points p = sources;
    p.insert(p.end(), coarse.begin(), coarse.end());
    return p;
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
  const Problem p;
  const IterativeSolution fast = IterativeSolver(p.collocation, p.sources, p.coarse, p.settings())
                                     .solve(roughValues(p.collocation));
  const DenseSolution dense =
      DenseSolver(p.collocation, p.sources, p.fresh)
          .solve(roughValues(p.collocation), Regularization::tikhonov, roughValues(p.fresh));
  EXPECT_LT(rmsError(fast, p.all(), p.fresh), 1.15 * rmsError(dense, p.sources, p.fresh));
  EXPECT_LE(fast.iterations, 5);
}

TEST(IterativeSolver, ResidualsAreTrueAndFall) {
  const Problem p;
  const IterativeSolution s = IterativeSolver(p.collocation, p.sources, p.coarse, p.settings())
                                  .solve(roughValues(p.collocation));
  ASSERT_EQ(s.residuals.size(), static_cast<std::size_t>(s.iterations) + 1);
  for (std::size_t i = 1; i < s.residuals.size(); ++i)
    EXPECT_LE(s.residuals[i], s.residuals[i - 1]);
  EXPECT_NEAR(rmsError(s, p.all(), p.collocation), s.residuals.back(), 1e-9);
}

TEST(IterativeSolver, AffineDataAreExact) {
  const Problem p;
  Matrix b(p.collocation.size(), 1);
  for (std::size_t i = 0; i < b.rows(); ++i)
    b(i, 0) = 3 + p.collocation[i].x - 2 * p.collocation[i].z;
  const IterativeSolution s =
      IterativeSolver(p.collocation, p.sources, p.coarse, p.settings()).solve(b);
  EXPECT_LT(s.residuals.back(), 1e-10);
  EXPECT_LT(s.weightNorm, 1e-8);
}

TEST(IterativeSolver, SameBitsForAnyNumberOfThreads) {
  const Problem p;
  const auto weights = [&] {
    return IterativeSolver(p.collocation, p.sources, p.coarse, p.settings())
        .solve(roughValues(p.collocation))
        .weights;
  };
  const Matrix all = weights();
  const ThreadLimit one(1);
  const Matrix single = weights();
  EXPECT_TRUE(std::equal(all.data(), all.data() + 2 * 1350, single.data()));
}

TEST(IterativeSolver, ScaleAndPlaceDoNotMatter) {
  const Problem p;
  const auto moved = [](Points q) {
    for (Vec3& v : q) v = 1e-3 * v + Vec3{4, 5, 6};
    return q;
  };
  IterativeSettings small = p.settings();
  small.spacing *= 1e-3;
  small.distance *= 1e-3;
  const Matrix b = roughValues(p.collocation);
  const auto one = IterativeSolver(p.collocation, p.sources, p.coarse, p.settings()).solve(b);
  const auto two =
      IterativeSolver(moved(p.collocation), moved(p.sources), moved(p.coarse), small).solve(b);
  EXPECT_EQ(one.iterations, two.iterations);
  EXPECT_NEAR(one.residuals.back() / two.residuals.back(), 1, 1e-3);
}

TEST(IterativeSolver, RefusesWhatCannotBe) {
  const Problem p;
  IterativeSettings s = p.settings();
  s.spacing = 0;
  EXPECT_THROW(IterativeSolver(p.collocation, p.sources, p.coarse, s), SettingError);
  s = p.settings();
  s.maxMemory = 10000;
  EXPECT_THROW(IterativeSolver(p.collocation, p.sources, p.coarse, s), MemoryError);
  EXPECT_THROW(IterativeSolver(p.collocation, {}, p.coarse, p.settings()), SettingError);
  EXPECT_THROW(IterativeSolver(p.coarse, p.sources, p.coarse, p.settings()), SettingError);
  Progress progress;
  progress.cancel();
  s = p.settings();
  s.progress = &progress;
  EXPECT_THROW(IterativeSolver(p.collocation, p.sources, p.coarse, s), Cancelled);
}

}  // namespace
}  // namespace innermap
