#include "innermap/field/harmonic_field.h"

#include <gtest/gtest.h>

#include "field/sphere_problem.h"
#include "innermap/core/error.h"

namespace innermap {
namespace {

using testing::withGradients;

// Central differences of second order: the error falls by 4 when the step halves.
TEST(HarmonicField, GradientIsTheSlopeOfTheValues) {
  const HarmonicField f = testing::someField();
  const Points points = testing::randomPoints(20, 9);
  const FieldSamples exact = f.evaluate(points, withGradients());
  double error[2] = {0, 0};
  for (int level = 0; level < 2; ++level) {
    const double h = 1e-2 / (1 << level);
    for (int a = 0; a < 3; ++a) {
      Points up = points, down = points;
      for (Vec3& p : up) p[a] += h;
      for (Vec3& p : down) p[a] -= h;
      const Matrix u = f.evaluate(up).values, d = f.evaluate(down).values;
      for (std::size_t k = 0; k < 3; ++k)
        for (std::size_t i = 0; i < points.size(); ++i)
          error[level] = std::max(error[level], std::abs((u(i, k) - d(i, k)) / (2 * h) -
                                                         exact.gradients(i, 3 * k + a)));
    }
  }
  EXPECT_NEAR(std::log2(error[0] / error[1]), 2, 0.1);
}

TEST(HarmonicField, MeanOverASphereIsTheValueAtItsCentre) {
  const HarmonicField f = testing::someField();
  const Points sphere = testing::spherePoints(20000, 1);
  const Matrix around = f.evaluate(sphere).values, centre = f.evaluate({Vec3{}}).values;
  for (std::size_t k = 0; k < 3; ++k) {
    double mean = 0;
    for (std::size_t i = 0; i < sphere.size(); ++i) mean += around(i, k) / 20000;
    EXPECT_NEAR(mean, centre(0, k), 1e-5);  // quadrature error of the lattice, O(1 / n) at best
  }
}

TEST(HarmonicField, OneThreadAndAllThreadsAgree) {
  const HarmonicField f = testing::someField();
  const Points points = testing::randomPoints(100, 4);
  const FieldSamples all = f.evaluate(points, withGradients());
  std::vector<double> values(300), gradients(900);
  f.evaluate(points.data(), 100, values.data(), gradients.data());
  for (std::size_t i = 0; i < 300; ++i) EXPECT_DOUBLE_EQ(values[i], all.values.data()[i]);
  for (std::size_t i = 0; i < 900; ++i) EXPECT_NEAR(gradients[i], all.gradients.data()[i], 1e-12);
}

TEST(HarmonicField, RefusesWrongShapes) {
  Affine affine;
  affine.coefficients = Matrix(4, 2);
  EXPECT_THROW(HarmonicField(Points(1), Matrix(1, 3), affine), DataError);
  affine.coefficients = Matrix(4, 3);
  affine.coefficients(0, 0) = std::nan("");
  EXPECT_THROW(HarmonicField(Points(1), Matrix(1, 3), affine), DataError);
}

}  // namespace
}  // namespace innermap
