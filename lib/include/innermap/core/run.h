// What a call of the library shares with its caller, all the way down: progress, cancelling, limits
// on time and memory. The caller enters a RunContext once, for the thread that calls:
//
//   RunContext run;  // or a class of one's own that shows what is reported
//   const RunScope scope(run);
//   const MapFit fit = fitMap(pair);  // run.cancel() from any thread makes it throw Cancelled
//
// All that runs below, on whatever thread of the library's, belongs to it. Without one nothing is
// reported and nothing cancelled. Cancelling is sticky. A poll is at most about 0.2 s away, except
// inside the singular value decomposition of DenseSolver (one LAPACK call).
//
// A deadline is softer: what tries, refines, repairs or goes in steps ends at it with what has been
// reached, and what a result cannot be without runs to its end. Such a result depends on the
// machine, and may differ from run to run; endedByTime() tells.
//
// What is known to take more memory than the limit is refused with a MemoryError before it begins;
// core/memory.h has the functions that look at the limit.
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "innermap/core/error.h"

namespace innermap {

class RunContext {
 public:
  RunContext() = default;
  virtual ~RunContext() = default;
  RunContext(const RunContext&) = delete;
  RunContext& operator=(const RunContext&) = delete;

  // Called when a stage goes on: its name in plain words ("placing samples") and the fraction of
  // it that is done, in [0, 1]. May be called from any thread; implementations must be thread-safe.
  virtual void report(std::string_view stage, double fraction) {
    (void)stage;
    (void)fraction;
  }

  void cancel() noexcept { cancelled_.store(true, std::memory_order_relaxed); }
  virtual bool cancelled() const noexcept { return cancelled_.load(std::memory_order_relaxed); }

  // From now; below 0: the deadline is past; infinity: there is none. Instead of one set before.
  void setSecondsLeft(double seconds) noexcept {
    deadline_.store(now() + seconds, std::memory_order_relaxed);
  }
  // Below 0 once the deadline is past; infinity without one.
  virtual double secondsLeft() const noexcept {
    return deadline_.load(std::memory_order_relaxed) - now();
  }

  // What the deadline cut short says so.
  virtual void endByTime() noexcept { endedByTime_.store(true, std::memory_order_relaxed); }
  bool endedByTime() const noexcept { return endedByTime_.load(std::memory_order_relaxed); }

  // Bytes that the process may hold; 0: no limit. To be set before work begins.
  void setMaxMemory(std::uint64_t bytes) noexcept { maxMemory_ = bytes; }
  std::uint64_t maxMemory() noexcept { return whole().maxMemory_; }

  // What the caller entered, of a part of it.
  virtual RunContext& whole() noexcept { return *this; }

 private:
  static double now() noexcept {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
  }

  std::atomic<bool> cancelled_{false}, endedByTime_{false};
  std::uint64_t maxMemory_ = 0;
  std::atomic<double> deadline_{std::numeric_limits<double>::infinity()};
};

namespace detail {
inline thread_local RunContext* currentRun = nullptr;
}

// Of the calling thread; null where none was entered.
inline RunContext* currentRun() noexcept { return detail::currentRun; }

// Enters a run, which must outlive it, until the scope ends; null: none.
class RunScope {
 public:
  explicit RunScope(RunContext& run) noexcept : RunScope(&run) {}
  explicit RunScope(RunContext* run) noexcept : before_(detail::currentRun) {
    detail::currentRun = run;
  }
  ~RunScope() { detail::currentRun = before_; }
  RunScope(const RunScope&) = delete;
  RunScope& operator=(const RunScope&) = delete;

 private:
  RunContext* const before_;
};

inline void throwIfCancelled() {
  if (const RunContext* run = currentRun(); run && run->cancelled()) throw Cancelled();
}

inline void reportProgress(std::string_view stage, double fraction) {
  throwIfCancelled();
  if (RunContext* run = currentRun()) run->report(stage, fraction);
}

// Whether what only improves a result is to end, as the deadline leaves less than the seconds that
// go on with it would take.
inline bool outOfTime(double seconds = 0) {
  RunContext* run = currentRun();
  if (!run || run->secondsLeft() > seconds) return false;
  run->endByTime();
  return true;
}

// Entered while it lives: reports a part of a stage, from 0 to 1, to the run around it as what it
// is of the whole, from `from` to `to`. Cancelled and out of time with that.
class PartOfStage : public RunContext {
 public:
  PartOfStage(double from, double to) : from_(from), to_(to) {}
  void report(std::string_view stage, double fraction) override {
    if (around_) around_->report(stage, from_ + fraction * (to_ - from_));
  }
  bool cancelled() const noexcept override {
    return RunContext::cancelled() || (around_ && around_->cancelled());
  }
  double secondsLeft() const noexcept override {
    return around_ ? around_->secondsLeft() : RunContext::secondsLeft();
  }
  void endByTime() noexcept override {
    RunContext::endByTime();
    if (around_) around_->endByTime();
  }
  RunContext& whole() noexcept override { return around_ ? around_->whole() : *this; }

 protected:
  const RunContext* around() const noexcept { return around_; }

 private:
  RunContext* const around_ = currentRun();
  const RunScope scope_{this};
  const double from_, to_;
};

// Gives a part of a job no more than `share`, in (0, 1], of the seconds that the run around it has
// left now.
class PartOfTime : public PartOfStage {
 public:
  explicit PartOfTime(double share) : PartOfStage(0, 1) {
    if (const RunContext* whole = around()) setSecondsLeft(share * whole->secondsLeft());
  }
  double secondsLeft() const noexcept override { return RunContext::secondsLeft(); }
};

// Threads. Loops are cut into blocks of a fixed size, so that what a block computes never depends
// on the number of threads; results are therefore the same for any number of them.

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

// Wall time by stage: what results say of where the time went.

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
