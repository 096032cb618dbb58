#include "solve/detail/blas_kernels.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <string>

namespace innermap {
namespace {

TEST(BlasKernels, AreNoFallbackWhereTheProcessorHasMore) {
  if (std::getenv("OPENBLAS_CORETYPE")) GTEST_SKIP() << "OPENBLAS_CORETYPE is set";
  const std::string kernels = chooseBlasKernels();
  if (kernels.empty()) GTEST_SKIP() << "not OpenBLAS";
#if defined(__x86_64__)
  if (!__builtin_cpu_supports("avx2")) GTEST_SKIP() << "an old processor";
  for (const char* fallback : {"Prescott", "Opteron", "Opteron_SSE3", "Katmai"})
    EXPECT_NE(kernels, fallback);
#endif
  EXPECT_EQ(std::getenv("OPENBLAS_CORETYPE"), nullptr);
  EXPECT_EQ(chooseBlasKernels(), kernels);
}

}  // namespace
}  // namespace innermap
