#include <fmt/format.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <limits>
#include <memory>
#include <thread>

#include "innermap/core/error.h"
#include "innermap/core/memory.h"
#include "innermap/core/run.h"

namespace innermap {
namespace {

// TBB starts its threads when there is work for them and ends the program where one cannot have its
// stack. Under a limit on address space they are therefore started at once, if there is room.
void startThreadsUnderLimit(std::size_t threads) {
  constexpr std::uint64_t kThread = 16u << 20, kRest = 32u << 20;  // stacks of 4 or 8 MB
  static std::atomic<std::size_t> started{1};
  if (threads <= started) return;
  const std::uint64_t left = addressSpaceLeft(), need = (threads - started) * kThread + kRest;
  if (left == std::numeric_limits<std::uint64_t>::max()) return;
  if (left < need)
    throw MemoryError(fmt::format(
        "{} threads need {} of address space, but the limit on it leaves {}; raise it (ulimit -v) "
        "or use fewer threads",
        threads, formatBytes(need), formatBytes(left)));
  std::atomic<std::size_t> running{0};
  const auto until = std::chrono::steady_clock::now() + std::chrono::seconds(1);
  tbb::task_arena(static_cast<int>(threads)).execute([&] {
    tbb::parallel_for(
        std::size_t(0), threads,
        [&](std::size_t) {
          ++running;
          while (running < threads && std::chrono::steady_clock::now() < until)
            std::this_thread::yield();
        },
        tbb::simple_partitioner());
  });
  started = threads;
}

}  // namespace

ThreadLimit::ThreadLimit(int threads) {
  const std::size_t cores = std::max(1u, std::thread::hardware_concurrency());
  const std::size_t count = threads > 0 ? static_cast<std::size_t>(threads) : cores;
  auto control =
      std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism, count);
  startThreadsUnderLimit(count);
  control_ = control.release();
}

ThreadLimit::~ThreadLimit() { delete static_cast<tbb::global_control*>(control_); }

void parallelBlocks(std::size_t count, std::size_t blockSize,
                    const std::function<void(std::size_t, std::size_t)>& body,
                    std::string_view stage) {
  const std::size_t size = std::max<std::size_t>(1, blockSize);
  const std::size_t blocks = (count + size - 1) / size;
  std::atomic<std::size_t> done{0};
  RunContext* const run = currentRun();
  tbb::parallel_for(std::size_t(0), blocks, [&](std::size_t block) {
    const RunScope scope(run);
    throwIfCancelled();
    body(block * size, std::min(count, (block + 1) * size));
    const std::size_t finished = ++done;
    if (run && !stage.empty() && finished * 100 / blocks != (finished - 1) * 100 / blocks)
      run->report(stage, static_cast<double>(finished) / static_cast<double>(blocks));
  });
  throwIfCancelled();
}

}  // namespace innermap
