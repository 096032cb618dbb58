#include <gtest/gtest.h>

#include "core/expect.h"
#include "innermap/core/error.h"
#include "innermap/solve/kernel_sum.h"
#include "innermap/solve/solver.h"
#include "solve/points.h"

namespace innermap {
namespace {

using testing::spherePoints;

// Harmonic: x^2 - y^2, exp(x) sin(y), x + 2 y z.
Matrix harmonicValues(const Points& points) {
  Matrix v(points.size(), 3);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3& p = points[i];
    v(i, 0) = p.x * p.x - p.y * p.y;
    v(i, 1) = std::exp(p.x) * std::sin(p.y);
    v(i, 2) = p.x + 2 * p.y * p.z;
  }
  return v;
}

Matrix evaluate(const DenseSolution& s, const Points& sources, const Points& points) {
  Matrix v = sumCharges(Charges(sources, s.weights), points, false).values;
  for (std::size_t k = 0; k < v.columns(); ++k)
    for (std::size_t i = 0; i < points.size(); ++i) v(i, k) += s.affine.value(points[i], k);
  return v;
}

double largestDifference(const Matrix& a, const Matrix& b) {
  double largest = 0;
  for (std::size_t i = 0; i < a.rows() * a.columns(); ++i)
    largest = std::max(largest, std::abs(a.data()[i] - b.data()[i]));
  return largest;
}

struct Problem {
  Points collocation = spherePoints(600, 1), sources = spherePoints(150, 1.8, 1),
         heldOut = spherePoints(300, 1, 2), inside = spherePoints(100, 0.6, 3);
};

class DenseSolverMethods : public ::testing::TestWithParam<Regularization> {};

TEST_P(DenseSolverMethods, ReachesAHarmonicFunctionInside) {
  const Problem p;
  const DenseSolver solver(p.collocation, p.sources, p.heldOut);
  const DenseSolution s =
      solver.solve(harmonicValues(p.collocation), GetParam(), harmonicValues(p.heldOut));
  // The error of charges at ratio 1.8 falls like 1.8^-degree; 150 charges resolve degree 11 or so
  // on the boundary: 1.8^-11 = 1.6e-3 of the little that exp(x) sin(y) has there (1 / 12!).
  EXPECT_LT(largestDifference(evaluate(s, p.sources, p.inside), harmonicValues(p.inside)), 1e-6);
  EXPECT_GT(s.rank, 20u);
  EXPECT_GE(s.condition, 1);
}

TEST_P(DenseSolverMethods, AffineDataNeedNoCharges) {
  const Problem p;
  Matrix b(p.collocation.size(), 1), h(p.heldOut.size(), 1);
  const auto f = [](const Vec3& q) { return 3 + q.x - 2 * q.y + 0.5 * q.z; };
  for (std::size_t i = 0; i < b.rows(); ++i) b(i, 0) = f(p.collocation[i]);
  for (std::size_t i = 0; i < h.rows(); ++i) h(i, 0) = f(p.heldOut[i]);
  const DenseSolution s = DenseSolver(p.collocation, p.sources, p.heldOut).solve(b, GetParam(), h);
  EXPECT_EQ(s.rank, 0u);
  EXPECT_LT(s.weightNorm, 1e-12);
  EXPECT_NEAR(s.affine.value({7, 8, 9}, 0), f({7, 8, 9}), 1e-12);
}

INSTANTIATE_TEST_SUITE_P(Methods, DenseSolverMethods,
                         ::testing::Values(Regularization::truncatedSvd, Regularization::tikhonov));

TEST(DenseSolver, ScaleAndPlaceDoNotMatter) {
  const Problem p;
  const double scale = 1e-3;
  const Vec3 shift{5, -7, 3};
  const auto moved = [&](Points q) {
    for (Vec3& v : q) v = scale * v + shift;
    return q;
  };
  const Matrix b = harmonicValues(p.collocation), h = harmonicValues(p.heldOut);
  const DenseSolution one =
      DenseSolver(p.collocation, p.sources, p.heldOut).solve(b, Regularization::tikhonov, h, 1e-8);
  const DenseSolution two = DenseSolver(moved(p.collocation), moved(p.sources), moved(p.heldOut))
                                .solve(b, Regularization::tikhonov, h, 1e-8);
  // Coordinates near 10 with an extent of 1e-3 carry 1e-16 * 1e4 of relative rounding, 1e-8
  // amplifies it by the square root at most where the values are concerned.
  EXPECT_LT(largestDifference(evaluate(one, p.sources, p.inside),
                              evaluate(two, moved(p.sources), moved(p.inside))),
            1e-7);
}

TEST(DenseSolver, NoiseAsksForMoreRegularisation) {
  const Problem p;
  const DenseSolver solver(p.collocation, p.sources, p.heldOut);
  const CounterRandom random(4, 4);
  Matrix b = harmonicValues(p.collocation), h = harmonicValues(p.heldOut);
  const double clean = solver.solve(b, Regularization::tikhonov, h).regularization;
  for (std::size_t i = 0; i < 3 * b.rows(); ++i) b.data()[i] += 1e-3 * (random.uniform(i) - 0.5);
  const DenseSolution noisy = solver.solve(b, Regularization::tikhonov, h);
  EXPECT_GT(noisy.regularization, 10 * clean);
  EXPECT_LT(noisy.heldOutRms, 2e-3);
}

TEST(DenseSolver, OneFactorizationServesManyRightHandSides) {
  const Problem p;
  const DenseSolver solver(p.collocation, p.sources, p.heldOut);
  const Matrix b = harmonicValues(p.collocation);
  const DenseSolution all = solver.solve(b, Regularization::tikhonov, {}, 1e-9);
  for (std::size_t k = 0; k < 3; ++k) {
    Matrix one(b.rows(), 1);
    std::copy_n(b.column(k), b.rows(), one.column(0));
    const DenseSolution s = solver.solve(one, Regularization::tikhonov, {}, 1e-9);
    for (std::size_t j = 0; j < p.sources.size(); ++j)
      EXPECT_NEAR(s.weights(j, 0), all.weights(j, k), 1e-6);
  }
}

TEST(DenseSolver, PointsInAPlaneAreNoTrouble) {
  Points flat = testing::randomPoints(80, 1);
  for (Vec3& q : flat) q.z = 2;
  Points sources = testing::randomPoints(20, 2);
  for (Vec3& q : sources) q.z = 3;
  Matrix b(80, 1);
  for (std::size_t i = 0; i < 80; ++i) b(i, 0) = flat[i].x;
  const DenseSolution s =
      DenseSolver(flat, sources, flat).solve(b, Regularization::truncatedSvd, b);
  EXPECT_LT(largestDifference(evaluate(s, sources, flat), b), 1e-10);
}

TEST(DenseSolver, RefusesWhatCannotBe) {
  const Problem p;
  EXPECT_THROW(DenseSolver(p.collocation, {}, {}), SettingError);
  EXPECT_THROW(DenseSolver(p.sources, p.sources, {}), SettingError);
  test::expectOverLimit(100000, [&] { DenseSolver(p.collocation, p.sources, p.heldOut); });
  const DenseSolver solver(p.collocation, p.sources, {});
  const Matrix b = harmonicValues(p.collocation);
  EXPECT_THROW(solver.solve(b, Regularization::tikhonov, {}), SettingError);
  EXPECT_THROW(solver.solve(b, Regularization::tikhonov, {}, -1.0), SettingError);
}

}  // namespace
}  // namespace innermap
