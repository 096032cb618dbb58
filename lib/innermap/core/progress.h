// Progress, cancellation and time limits: the one convention for the whole library.
//
// Every settings struct ends with `Progress* progress = nullptr`. Long computations report to it
// and poll it; when cancel() was called, from any thread or a signal handler, they throw Cancelled.
// Cancelling is sticky. A poll is at most about 0.2 s away, except inside the singular value
// decomposition of DenseSolver (one LAPACK call).
//
// A deadline is softer: what tries, refines, repairs or goes in steps ends at it with what has been
// reached, and what a result cannot be without runs to its end. Such a result depends on the
// machine, and may differ from run to run; endedByTime() tells.
#pragma once

#include <atomic>
#include <chrono>
#include <limits>
#include <string_view>

#include "innermap/core/error.h"

namespace innermap {

class Progress {
 public:
  virtual ~Progress() = default;

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

 private:
  static double now() noexcept {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
  }

  std::atomic<bool> cancelled_{false}, endedByTime_{false};
  std::atomic<double> deadline_{std::numeric_limits<double>::infinity()};
};

inline void throwIfCancelled(const Progress* progress) {
  if (progress && progress->cancelled()) throw Cancelled();
}

inline void reportProgress(Progress* progress, std::string_view stage, double fraction) {
  if (!progress) return;
  throwIfCancelled(progress);
  progress->report(stage, fraction);
}

// Whether what only improves a result is to end, as the deadline leaves less than the seconds that
// go on with it would take.
inline bool outOfTime(Progress* progress, double seconds = 0) {
  if (!progress || progress->secondsLeft() > seconds) return false;
  progress->endByTime();
  return true;
}

// Reports a part of a stage, from 0 to 1, as what it is of the whole: from `from` to `to`.
// Cancelled and out of time with the whole, which must outlive it and may be null.
class PartOfStage : public Progress {
 public:
  PartOfStage(Progress* whole, double from, double to) : whole_(whole), from_(from), to_(to) {}
  void report(std::string_view stage, double fraction) override {
    reportProgress(whole_, stage, from_ + fraction * (to_ - from_));
  }
  bool cancelled() const noexcept override {
    return Progress::cancelled() || (whole_ && whole_->cancelled());
  }
  double secondsLeft() const noexcept override {
    return whole_ ? whole_->secondsLeft() : Progress::secondsLeft();
  }
  void endByTime() noexcept override {
    Progress::endByTime();
    if (whole_) whole_->endByTime();
  }

 private:
  Progress* const whole_;
  const double from_, to_;
};

// Gives a part of a job no more than `share`, in (0, 1], of the seconds that the whole has left
// now.
class PartOfTime : public PartOfStage {
 public:
  PartOfTime(Progress* whole, double share) : PartOfStage(whole, 0, 1) {
    if (whole) setSecondsLeft(share * whole->secondsLeft());
  }
  double secondsLeft() const noexcept override { return Progress::secondsLeft(); }
};

}  // namespace innermap
