#include "innermap/solve/kernel_simd.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace innermap::simd {
namespace {

TEST(KernelSimd, ColumnIsInverseDistanceToTheLastDigits) {
  const std::size_t count = 77;
  std::vector<double> x(2 * kPadding), y(x.size()), z(x.size()), out(count + 1, -1);
  for (std::size_t i = 0; i < x.size(); ++i) {
    x[i] = std::pow(10.0, -15 + 0.3 * static_cast<double>(i));
    y[i] = 0.5 * x[i];
  }
  kernelColumn(x.data(), y.data(), z.data(), count, 0, 0, 0, 3, out.data());
  for (std::size_t i = 0; i < count; ++i) {
    const double expected = 3 / std::hypot(x[i], y[i]);
    EXPECT_NEAR(out[i] / expected, 1, 1e-15) << i;
  }
  EXPECT_EQ(out[count], -1) << "wrote past the end";
}

TEST(KernelSimd, NamesItsTarget) { EXPECT_STRNE(targetName(), ""); }

}  // namespace
}  // namespace innermap::simd
