#include <gtest/gtest.h>

#include "field/sphere_problem.h"
#include "innermap/core/error.h"
#include "innermap/field/harmonic_field.h"

namespace innermap {
namespace {

using testing::withGradients;

TEST(HarmonicMap, RowsOfTheJacobianBelongToComponents) {
  const HarmonicField field = testing::someField();
  const HarmonicMap map(field);
  const Vec3 p{0.2, -0.1, 0.3};
  const FieldSamples s = field.evaluate({p}, withGradients());
  const Mat3 j = map.jacobian(p);
  const Vec3 q = map(p);
  for (int r = 0; r < 3; ++r) {
    EXPECT_NEAR(q[r], s.values(0, r), 1e-14);
    for (int a = 0; a < 3; ++a) EXPECT_NEAR(j[r][a], s.gradients(0, 3 * r + a), 1e-13);
  }
}

TEST(HarmonicMap, NeedsThreeChannels) {
  Affine affine;
  affine.coefficients = Matrix(4, 2);
  EXPECT_THROW(HarmonicMap(HarmonicField(Points(1), Matrix(1, 2), affine)), DataError);
}

}  // namespace
}  // namespace innermap
