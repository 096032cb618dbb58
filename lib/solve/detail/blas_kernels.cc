#include "solve/detail/blas_kernels.h"

#include <cstdlib>
#include <cstring>
#include <string>

// Absent from OpenBLAS built for one processor, and from other libraries.
// NOLINTBEGIN(readability-identifier-naming): not ours.
extern "C" {
__attribute__((weak)) char* openblas_get_corename();
__attribute__((weak)) void gotoblas_dynamic_init();
__attribute__((weak)) void gotoblas_dynamic_quit();
}
// NOLINTEND(readability-identifier-naming)

namespace innermap {
namespace {

constexpr char kVariable[] = "OPENBLAS_CORETYPE";

// The newest kernels that need no more than this processor has; null where that is not known.
const char* fittingKernels() {
#if defined(__x86_64__)
  __builtin_cpu_init();
  if (!__builtin_cpu_supports("avx2") || !__builtin_cpu_supports("fma")) return nullptr;
  const bool wide = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
                    __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl") &&
                    __builtin_cpu_supports("avx512cd");
  return wide ? "SkylakeX" : "Haswell";
#else
  return nullptr;
#endif
}

// What OpenBLAS falls back to for models of Intel, AMD and others that it does not know.
bool isFallback(const char* kernels) {
  for (const char* name : {"Prescott", "Opteron", "Opteron_SSE3", "Katmai", "Generic"})
    if (std::strcmp(kernels, name) == 0) return true;
  return false;
}

}  // namespace

const char* blasKernels() { return openblas_get_corename ? openblas_get_corename() : ""; }

void useBlasKernels(const char* name) {
  if (!gotoblas_dynamic_init || !gotoblas_dynamic_quit) return;
  const char* before = std::getenv(kVariable);
  const std::string kept = before ? before : "";
  setenv(kVariable, name, 1);
  gotoblas_dynamic_quit();
  gotoblas_dynamic_init();
  if (before)
    setenv(kVariable, kept.c_str(), 1);
  else
    unsetenv(kVariable);
}

const char* chooseBlasKernels() {
  if (!openblas_get_corename) return "";
  const char* fitting = fittingKernels();
  if (fitting && !std::getenv(kVariable) && isFallback(blasKernels())) useBlasKernels(fitting);
  return blasKernels();
}

}  // namespace innermap
