#include "innermap/core/run.h"

#include <gtest/gtest.h>

#include <string>
#include <thread>

namespace innermap {
namespace {

TEST(Run, WithoutOneNothingIsReportedOrCancelled) {
  EXPECT_EQ(currentRun(), nullptr);
  EXPECT_NO_THROW(throwIfCancelled());
  EXPECT_NO_THROW(reportProgress("stage", 0.5));
  EXPECT_FALSE(outOfTime(1e9));
  PartOfStage part(0, 1);
  EXPECT_NO_THROW(reportProgress("stage", 1));
  EXPECT_FALSE(outOfTime());
}

TEST(Run, CancellingIsSticky) {
  RunContext run;
  const RunScope scope(run);
  EXPECT_NO_THROW(throwIfCancelled());
  run.cancel();
  EXPECT_THROW(throwIfCancelled(), Cancelled);
  EXPECT_THROW(reportProgress("stage", 0), Cancelled);
}

TEST(Run, ScopesNest) {
  RunContext outer, inner;
  const RunScope scope(outer);
  {
    const RunScope within(inner);
    EXPECT_EQ(currentRun(), &inner);
    const RunScope none(nullptr);
    EXPECT_EQ(currentRun(), nullptr);
  }
  EXPECT_EQ(currentRun(), &outer);
}

TEST(Run, IsTheThreadsOwn) {
  RunContext run;
  const RunScope scope(run);
  RunContext* other = &run;
  std::thread([&] { other = currentRun(); }).join();
  EXPECT_EQ(other, nullptr);
}

struct Recorder : RunContext {
  void report(std::string_view stage, double fraction) override {
    last = std::string(stage) + " " + std::to_string(fraction);
  }
  std::string last;
};

TEST(Run, ReportsArrive) {
  Recorder recorder;
  const RunScope scope(recorder);
  reportProgress("placing", 0.5);
  EXPECT_EQ(recorder.last, "placing 0.500000");
}

TEST(Run, APartIsReportedAsOfTheWhole) {
  Recorder whole;
  const RunScope scope(whole);
  const PartOfStage part(0.5, 0.75);
  reportProgress("placing", 0);
  EXPECT_EQ(whole.last, "placing 0.500000");
  reportProgress("placing", 1);
  EXPECT_EQ(whole.last, "placing 0.750000");
  EXPECT_FALSE(part.cancelled());
  whole.cancel();
  EXPECT_TRUE(part.cancelled());
  EXPECT_THROW(throwIfCancelled(), Cancelled);
}

TEST(Run, OfAPartIsWhatTheCallerEntered) {
  RunContext run;
  const RunScope scope(run);
  EXPECT_EQ(&currentRun()->whole(), &run);
  const PartOfStage part(0, 0.5);
  const PartOfTime within(0.5);
  EXPECT_EQ(&currentRun()->whole(), &run);
}

TEST(Run, OutOfTimeAtTheDeadline) {
  RunContext run;
  const RunScope scope(run);
  EXPECT_FALSE(outOfTime(1e9));
  run.setSecondsLeft(1000);
  EXPECT_FALSE(outOfTime(1));
  EXPECT_FALSE(run.endedByTime());
  EXPECT_TRUE(outOfTime(2000));
  EXPECT_TRUE(run.endedByTime());
  EXPECT_NO_THROW(throwIfCancelled());
}

TEST(Run, APartHasTheDeadlineOfTheWhole) {
  RunContext whole;
  const RunScope scope(whole);
  const PartOfStage part(0, 1);
  EXPECT_FALSE(outOfTime());
  whole.setSecondsLeft(0);
  EXPECT_TRUE(outOfTime());
  EXPECT_TRUE(whole.endedByTime());
}

TEST(Run, APartOfTheTimeEndsBeforeTheWhole) {
  RunContext whole;
  const RunScope scope(whole);
  {
    const PartOfTime unbounded(0.5);
    EXPECT_FALSE(outOfTime(1e9));
  }
  whole.setSecondsLeft(1000);
  {
    const PartOfTime half(0.5);
    EXPECT_FALSE(outOfTime(400));
    EXPECT_TRUE(outOfTime(600));
    EXPECT_TRUE(whole.endedByTime());
    whole.cancel();
    EXPECT_TRUE(half.cancelled());
  }
  EXPECT_FALSE(outOfTime(600));
}

}  // namespace
}  // namespace innermap
