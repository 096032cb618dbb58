// Threads. Loops are cut into blocks of a fixed size, so that what a block computes never depends
// on the number of threads; results are therefore the same for any number of them.
#pragma once

#include <cstddef>
#include <functional>
#include <string_view>

#include "innermap/core/run.h"

namespace innermap {

// Bounds the number of threads used by the whole process while it lives; 0 means all cores. (BLAS
// is kept to the calling thread where it is called: see SingleThreadedBlas.) Where address space is
// limited (ulimit -v) the threads are started here; throws MemoryError where it does not hold them.
class ThreadLimit {
 public:
  explicit ThreadLimit(int threads);
  ~ThreadLimit();
  ThreadLimit(const ThreadLimit&) = delete;
  ThreadLimit& operator=(const ThreadLimit&) = delete;

 private:
  void* control_;
};

// Calls body(begin, end) for consecutive blocks of `blockSize` indices that cover [0, count).
// All belong to the caller's run: it is polled between blocks (Cancelled), and told the share done
// when `stage` is not empty. Exceptions thrown by body come out here.
void parallelBlocks(std::size_t count, std::size_t blockSize,
                    const std::function<void(std::size_t, std::size_t)>& body,
                    std::string_view stage = {});

}  // namespace innermap
