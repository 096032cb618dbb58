// Progress and cancellation: the one convention for the whole library.
//
// Every settings struct ends with `Progress* progress = nullptr`. Long computations report to it
// and poll it; when cancel() was called, from any thread or a signal handler, they throw Cancelled.
// Cancelling is sticky. A poll is at most about 0.2 s away, except inside the singular value
// decomposition of DenseSolver (one LAPACK call).
#pragma once

#include <atomic>
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

 private:
  std::atomic<bool> cancelled_{false};
};

inline void throwIfCancelled(const Progress* progress) {
  if (progress && progress->cancelled()) throw Cancelled();
}

inline void reportProgress(Progress* progress, std::string_view stage, double fraction) {
  if (!progress) return;
  throwIfCancelled(progress);
  progress->report(stage, fraction);
}

// Reports a part of a stage, from 0 to 1, as what it is of the whole: from `from` to `to`.
// Cancelled with the whole, which must outlive it and may be null.
class PartOfStage : public Progress {
 public:
  PartOfStage(Progress* whole, double from, double to) : whole_(whole), from_(from), to_(to) {}
  void report(std::string_view stage, double fraction) override {
    reportProgress(whole_, stage, from_ + fraction * (to_ - from_));
  }
  bool cancelled() const noexcept override {
    return Progress::cancelled() || (whole_ && whole_->cancelled());
  }

 private:
  Progress* const whole_;
  const double from_, to_;
};

}  // namespace innermap
