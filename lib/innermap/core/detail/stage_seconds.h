// How long the stages of a longer computation took.
#pragma once

#include <chrono>
#include <string>
#include <utility>
#include <vector>

#include "innermap/core/progress.h"

namespace innermap {

using StageSeconds = std::vector<std::pair<std::string, double>>;  // in order; each stage once

inline void addSeconds(StageSeconds& stages, const std::string& stage, double seconds) {
  for (auto& [name, sum] : stages)
    if (name == stage) {
      sum += seconds;
      return;
    }
  stages.emplace_back(stage, seconds);
}

// Adds the time that it lives to a stage.
class StageTimer {
 public:
  StageTimer(StageSeconds& stages, std::string stage) : stages_(stages), stage_(std::move(stage)) {}
  ~StageTimer() {
    addSeconds(stages_, stage_,
               std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count());
  }
  StageTimer(const StageTimer&) = delete;
  StageTimer& operator=(const StageTimer&) = delete;

 private:
  StageSeconds& stages_;
  std::string stage_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

// What `body` returns; its wall time is added to `stages`. Throws Cancelled before it starts.
template <class Body>
auto timedStage(StageSeconds& stages, const std::string& stage, const Progress* progress,
                const Body& body) {
  throwIfCancelled(progress);
  const StageTimer timer(stages, stage);
  return body();
}

}  // namespace innermap
