#include <gtest/gtest.h>

#include <atomic>
#include <mutex>
#include <vector>

#include "innermap/core/error.h"
#include "innermap/core/run.h"

namespace innermap {
namespace {

TEST(Parallel, BlocksCoverEverythingOnce) {
  for (const std::size_t count : {0, 1, 7, 100, 1001}) {
    std::vector<std::atomic<int>> seen(count);
    parallelBlocks(count, 7, [&](std::size_t begin, std::size_t end) {
      EXPECT_EQ(begin % 7, 0u);
      for (std::size_t i = begin; i < end; ++i) ++seen[i];
    });
    for (const auto& s : seen) EXPECT_EQ(s, 1);
  }
}

TEST(Parallel, ExceptionsComeOut) {
  EXPECT_THROW(parallelBlocks(10, 1,
                              [](std::size_t begin, std::size_t) {
                                if (begin == 5) throw DataError("five");
                              }),
               DataError);
}

TEST(Parallel, CancellingFromABlockStopsTheRest) {
  RunContext run;
  const RunScope scope(run);
  std::atomic<int> ran{0};
  EXPECT_THROW(parallelBlocks(100000, 1,
                              [&](std::size_t, std::size_t) {
                                ++ran;
                                run.cancel();
                              }),
               Cancelled);
  EXPECT_LT(ran, 1000);
}

TEST(Parallel, ProgressEndsAtOne) {
  struct Recorder : RunContext {
    void report(std::string_view, double fraction) override {
      const std::lock_guard<std::mutex> lock(mutex);
      largest = std::max(largest, fraction);
    }
    std::mutex mutex;
    double largest = 0;
  } recorder;
  const RunScope scope(recorder);
  parallelBlocks(
      1000, 3, [](std::size_t, std::size_t) {}, "test");
  EXPECT_DOUBLE_EQ(recorder.largest, 1);
}

TEST(Parallel, BlocksBelongToTheRunOfTheCaller) {
  RunContext run;
  const RunScope scope(run);
  std::atomic<int> others{0};
  parallelBlocks(1000, 1, [&](std::size_t, std::size_t) {
    if (currentRun() != &run) ++others;
  });
  EXPECT_EQ(others, 0);
  EXPECT_EQ(currentRun(), &run);
}

TEST(Parallel, ThreadLimitHolds) {
  const ThreadLimit one(1);
  std::mutex mutex;
  parallelBlocks(200, 1, [&](std::size_t, std::size_t) {
    ASSERT_TRUE(mutex.try_lock()) << "two blocks at a time";
    mutex.unlock();
  });
}

}  // namespace
}  // namespace innermap
