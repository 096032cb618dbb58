#include "solve/vector_code.h"

#include <fmt/format.h>
#include <hwy/targets.h>

#include <cstdint>

#include "innermap/core/error.h"
#include "innermap/solve/kernel_sum.h"
#include "solve/detail/blas_kernels.h"

namespace innermap {
namespace {

struct Kind {
  const char* name;
  const char* kernels;   // of OpenBLAS
  std::int64_t highway;  // the best target allowed; better ones have lower bits
};
constexpr Kind kKinds[] = {{"avx2", "Haswell", HWY_AVX2}, {"avx512", "SkylakeX", HWY_AVX3}};

}  // namespace

std::string vectorCode() {
  const std::string kernels = blasKernels();
  return instructionSet() + (kernels.empty() ? "" : ", " + kernels);
}

const std::vector<std::string>& cpuTargets() {
  static const std::vector<std::string> kNames = [] {
    std::vector<std::string> names;
    for (const Kind& kind : kKinds) names.emplace_back(kind.name);
    return names;
  }();
  return kNames;
}

void setCpuTarget(const std::string& setting, const std::string& name) {
  for (const Kind& kind : kKinds) {
    if (name != kind.name) continue;
    if ((hwy::SupportedTargets() & kind.highway) == 0)
      throw SettingError(setting, fmt::format("this processor has no {}; choose {}", name,
                                              fmt::join(cpuTargets(), " or ")));
    hwy::DisableTargets(kind.highway - 1);
    useBlasKernels(kind.kernels);
    return;
  }
  throw SettingError(setting, fmt::format("'{}' is not {}", name, fmt::join(cpuTargets(), " or ")));
}

}  // namespace innermap
