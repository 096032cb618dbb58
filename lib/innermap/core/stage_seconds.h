// Wall time by stage: what results say of where the time went.
#pragma once

#include <chrono>
#include <exception>
#include <string>
#include <utility>
#include <vector>

namespace innermap {

// (stage, seconds), in the order in which the stages were first met.
using StageSeconds = std::vector<std::pair<std::string, double>>;

// Adds to the stage's time, or appends the stage.
void addSeconds(StageSeconds& stages, const std::string& stage, double seconds);
void addSeconds(StageSeconds& stages, const StageSeconds& more);

// Calls `body` and adds its wall time to the stage; nothing is added when it throws.
template <class Body>
decltype(auto) timed(StageSeconds& stages, const std::string& stage, Body&& body) {
  struct Watch {
    StageSeconds& stages;
    const std::string& stage;
    std::chrono::steady_clock::time_point start = std::chrono::steady_clock::now();
    int thrown = std::uncaught_exceptions();
    ~Watch() noexcept(false) {  // not while another exception flies
      if (std::uncaught_exceptions() > thrown) return;
      const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
      addSeconds(stages, stage, elapsed.count());
    }
  } watch{stages, stage};
  return body();
}

}  // namespace innermap
