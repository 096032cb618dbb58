#include <gtest/gtest.h>

#include <cmath>

#include "innermap/field/field_file.h"

namespace innermap {
namespace {

TEST(FitFacts, AreReadAsTheyWereWritten) {
  BoundaryError error{.rms = 1e-4, .p99 = 0.000312345678, .max = 2e-3, .samples = 20000};
  Facts facts = factsOf(error);
  for (const auto& fact : factsOfTolerance(1e-3, 5e-4, true)) facts.push_back(fact);
  const FitFacts read = fitFacts(facts);
  EXPECT_NEAR(read.error.rms, error.rms, 1e-9 * error.rms);
  EXPECT_NEAR(read.error.p99, error.p99, 1e-8 * error.p99);
  EXPECT_EQ(read.error.samples, 20000u);
  EXPECT_TRUE(std::isnan(read.error.bound));
  EXPECT_NEAR(read.tolerance.value(), 1e-3, 1e-12);
  EXPECT_NEAR(read.reached.value(), 5e-4, 1e-12);
  EXPECT_TRUE(read.met.value());
}

TEST(FitFacts, OfForeignTextsAreNotKnown) {
  const FitFacts read = fitFacts({{"boundary_error_p99", "small"},
                                  {"boundary_error_samples", "-3"},
                                  {"tolerance_met", "perhaps"}});
  EXPECT_TRUE(std::isnan(read.error.p99));
  EXPECT_EQ(read.error.samples, 0u);
  EXPECT_FALSE(read.tolerance || read.met);
}

}  // namespace
}  // namespace innermap
