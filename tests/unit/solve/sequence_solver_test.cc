#include "innermap/solve/sequence_solver.h"

#include <gtest/gtest.h>

#include "innermap/core/error.h"
#include "innermap/solve/kernel_sum.h"
#include "solve/points.h"

namespace innermap {
namespace {

using testing::spherePoints;

IterativeSolver ballSolver() {
  const double h = std::sqrt(4 * M_PI / 1200);
  return IterativeSolver(spherePoints(3600, 1), {{spherePoints(150, 1.4, 2), 0.3, 0.4},
                                                 {spherePoints(1200, 1 + h, 1), h, h}});
}

double trueResidual(const IterativeSolver& solver, const IterativeSolution& s,
                    const Matrix& values) {
  const Points points = spherePoints(3600, 1);
  const Matrix sums = sumCharges(Charges(solver.sources(), s.weights), points, false).values;
  double square = 0;
  for (std::size_t k = 0; k < values.columns(); ++k)
    for (std::size_t i = 0; i < points.size(); ++i)
      square += std::pow(values(i, k) - sums(i, k) - s.affine.value(points[i], k), 2);
  return std::sqrt(square / static_cast<double>(points.size()));
}

// A kink that wanders.
Matrix frame(double time) {
  const Points points = spherePoints(3600, 1);
  Matrix v(points.size(), 3);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3& p = points[i];
    v(i, 0) = p.x + std::abs(p.y - 0.3 * std::sin(time));
    v(i, 1) = p.y + 0.5 * std::abs(std::sin(3 * p.x + time));
    v(i, 2) = time * p.z;
  }
  return v;
}

TEST(SequenceSolver, LaterFramesAreAsGoodAndStartNearer) {
  const IterativeSolver alone = ballSolver();
  SequenceSolver sequence(ballSolver());
  int iterations = 0, iterationsAlone = 0;
  for (int f = 0; f < 12; ++f) {
    SCOPED_TRACE("frame " + std::to_string(f));
    const Matrix values = frame(0.2 * f);
    const IterativeSolution one = alone.solve(values), kept = sequence.solve(values);
    if (f == 0) {
      EXPECT_EQ(one.residuals, kept.residuals);
    } else {
      EXPECT_LT(kept.residuals.front(), 0.3 * one.residuals.front());
    }
    EXPECT_LT(kept.residuals.back(), 1.05 * one.residuals.back());
    EXPECT_LT(kept.weightNorm, 2 * one.weightNorm);
    EXPECT_NEAR(trueResidual(alone, kept, values), kept.residuals.back(), 1e-6);
    iterations += kept.iterations;
    iterationsAlone += one.iterations;
  }
  EXPECT_LE(iterations, 1.25 * iterationsAlone);
}

TEST(SequenceSolver, AnythingMayFollow) {
  const IterativeSolver alone = ballSolver();
  SequenceSolver sequence(ballSolver());
  sequence.solve(Matrix(3600, 3));
  Matrix huge = frame(1);
  for (std::size_t i = 0; i < 3 * 3600; ++i) huge.data()[i] *= 1e6;
  for (const Matrix& values : {frame(0), huge, frame(1), frame(1)})
    EXPECT_LT(sequence.solve(values).residuals.back(), 1.1 * alone.solve(values).residuals.back());
  EXPECT_THROW(sequence.solve(Matrix(5, 3)), DataError);
  const Matrix one(3600, 1);
  EXPECT_EQ(sequence.solve(one).weights.columns(), 1u);
}

}  // namespace
}  // namespace innermap
