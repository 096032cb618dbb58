#include "solve/detail/blas_memory.h"

#include <fmt/format.h>
#include <tbb/global_control.h>

#include <cstdint>
#include <limits>
#include <mutex>
#include <vector>

#include "innermap/core/error.h"
#include "innermap/core/memory.h"

// Absent from other libraries; those that have them keep what is freed for the next that asks.
// NOLINTBEGIN(readability-identifier-naming): not ours.
extern "C" {
__attribute__((weak)) void* blas_memory_alloc(int position);
__attribute__((weak)) void blas_memory_free(void* buffer);
}
// NOLINTEND(readability-identifier-naming)

namespace innermap {
namespace {

constexpr std::uint64_t kBuffer = 128u << 20;  // as mapped on x86-64 with the newest kernels
constexpr std::uint64_t kThread = 16u << 20;   // its stack, and what is allocated by it
constexpr std::uint64_t kRest = 64u << 20;

}  // namespace

void requireBlasMemory() {
  if (!blas_memory_alloc || !blas_memory_free) return;
  const std::uint64_t left = addressSpaceLeft();
  if (left == std::numeric_limits<std::uint64_t>::max()) return;
  static std::mutex mutex;
  static std::size_t mapped = 0;
  const std::lock_guard<std::mutex> lock(mutex);
  const std::size_t threads =
      tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
  if (mapped >= threads) return;
  const std::uint64_t each = kBuffer + kThread, need = (threads - mapped) * each + kRest;
  if (left < need) {
    const std::uint64_t fit = left > kRest ? mapped + (left - kRest) / each : mapped;
    throw MemoryError(fmt::format(
        "linear algebra (OpenBLAS) on {} threads needs {} of address space, but the limit "
        "on it leaves {}; raise it (ulimit -v){}",
        threads, formatBytes(need), formatBytes(left),
        fit > 0 ? fmt::format(" or use at most {} threads (--threads)", fit) : ""));
  }
  std::vector<void*> buffers;
  for (std::size_t i = 0; i < threads; ++i) buffers.push_back(blas_memory_alloc(0));
  for (void* buffer : buffers) blas_memory_free(buffer);
  mapped = threads;
}

}  // namespace innermap
