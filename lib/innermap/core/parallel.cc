#include "innermap/core/parallel.h"

#include <tbb/global_control.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <thread>

namespace innermap {

ThreadLimit::ThreadLimit(int threads) {
  const int cores = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  control_ = new tbb::global_control(tbb::global_control::max_allowed_parallelism,
                                     static_cast<std::size_t>(threads > 0 ? threads : cores));
}

ThreadLimit::~ThreadLimit() { delete static_cast<tbb::global_control*>(control_); }

void parallelBlocks(std::size_t count, std::size_t blockSize,
                    const std::function<void(std::size_t, std::size_t)>& body, Progress* progress,
                    std::string_view stage) {
  const std::size_t size = std::max<std::size_t>(1, blockSize);
  const std::size_t blocks = (count + size - 1) / size;
  std::atomic<std::size_t> done{0};
  tbb::parallel_for(std::size_t(0), blocks, [&](std::size_t block) {
    throwIfCancelled(progress);
    body(block * size, std::min(count, (block + 1) * size));
    const std::size_t finished = ++done;
    if (progress && !stage.empty() && finished * 100 / blocks != (finished - 1) * 100 / blocks)
      progress->report(stage, static_cast<double>(finished) / static_cast<double>(blocks));
  });
  throwIfCancelled(progress);
}

}  // namespace innermap
