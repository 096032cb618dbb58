#include "solve/detail/kernel_simd.h"

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

// Positive weights: nothing cancels, so errors are relative to the sums.
TEST(KernelSimd, RoundingIsWhatItSays) {
  const std::size_t count = 75, sources = 700, stride = 96;
  std::vector<double> x(2 * kPadding), y(x.size()), z(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    x[i] = std::sin(1.0 * static_cast<double>(i));
    y[i] = std::cos(2.0 * static_cast<double>(i));
    z[i] = std::sin(3.0 * static_cast<double>(i));
  }
  for (const int channels : {1, 2, 3}) {
    std::vector<double> charges;
    for (std::size_t j = 0; j < sources; ++j) {
      const double t = static_cast<double>(j);
      charges.insert(charges.end(), {2 * std::cos(t), 2 * std::sin(t), std::cos(0.1 * t)});
      for (int k = 0; k < channels; ++k) charges.push_back(1 + std::sin(t * (k + 1.5)));
    }
    const auto sums = [&](Rounding rounding) {
      std::vector<double> out(3 * stride, -1);
      sumCharges(charges.data(), sources, channels, x.data(), y.data(), z.data(), count, stride,
                 out.data(), nullptr, rounding);
      return out;
    };
    const std::vector<double> full = sums(Rounding::full), rough = sums(Rounding::rough),
                              single = sums(Rounding::single);
    for (std::size_t k = 0; k < 3; ++k)
      for (std::size_t i = 0; i < count; ++i) {
        const std::size_t at = k * stride + i;
        if (k >= static_cast<std::size_t>(channels)) {
          EXPECT_EQ(single[at], -1) << "wrote past the channels";
          continue;
        }
        EXPECT_NEAR(rough[at] / full[at], 1, 1e-7);
        EXPECT_NEAR(single[at] / full[at], 1, 2e-6);
      }
  }
}

TEST(KernelSimd, NamesItsTarget) { EXPECT_STRNE(targetName(), ""); }

}  // namespace
}  // namespace innermap::simd
