// A limit on memory for the tests of what keeps to it.
#pragma once

#include <cstdint>

#include "innermap/core/run.h"

namespace innermap {

// While it lives, the thread's calls belong to a run whose process may hold `bytes`.
class MemoryLimit {
 public:
  explicit MemoryLimit(std::uint64_t bytes) { run_.setMaxMemory(bytes); }

 private:
  RunContext run_;
  const RunScope scope_{run_};
};

}  // namespace innermap
