#include "innermap/core/progress.h"

#include <gtest/gtest.h>

#include <string>

namespace innermap {
namespace {

TEST(Progress, CancellingIsSticky) {
  Progress progress;
  EXPECT_NO_THROW(throwIfCancelled(&progress));
  EXPECT_NO_THROW(throwIfCancelled(nullptr));
  progress.cancel();
  EXPECT_THROW(throwIfCancelled(&progress), Cancelled);
  EXPECT_THROW(reportProgress(&progress, "stage", 0), Cancelled);
}

struct Recorder : Progress {
  void report(std::string_view stage, double fraction) override {
    last = std::string(stage) + " " + std::to_string(fraction);
  }
  std::string last;
};

TEST(Progress, ReportsArrive) {
  Recorder recorder;
  reportProgress(&recorder, "placing", 0.5);
  EXPECT_EQ(recorder.last, "placing 0.500000");
}

TEST(Progress, APartIsReportedAsOfTheWhole) {
  Recorder whole;
  PartOfStage part(&whole, 0.5, 0.75);
  reportProgress(&part, "placing", 0);
  EXPECT_EQ(whole.last, "placing 0.500000");
  reportProgress(&part, "placing", 1);
  EXPECT_EQ(whole.last, "placing 0.750000");
  EXPECT_FALSE(part.cancelled());
  whole.cancel();
  EXPECT_TRUE(part.cancelled());
  PartOfStage ofNone(nullptr, 0, 1);
  EXPECT_NO_THROW(reportProgress(&ofNone, "placing", 1));
}

TEST(Progress, OutOfTimeAtTheDeadline) {
  Progress progress;
  EXPECT_FALSE(outOfTime(&progress, 1e9));
  EXPECT_FALSE(outOfTime(nullptr, 1e9));
  progress.setSecondsLeft(1000);
  EXPECT_FALSE(outOfTime(&progress, 1));
  EXPECT_FALSE(progress.endedByTime());
  EXPECT_TRUE(outOfTime(&progress, 2000));
  EXPECT_TRUE(progress.endedByTime());
  EXPECT_NO_THROW(throwIfCancelled(&progress));
}

TEST(Progress, APartHasTheDeadlineOfTheWhole) {
  Progress whole;
  PartOfStage part(&whole, 0, 1), ofNone(nullptr, 0, 1);
  EXPECT_FALSE(outOfTime(&part));
  EXPECT_FALSE(outOfTime(&ofNone));
  whole.setSecondsLeft(0);
  EXPECT_TRUE(outOfTime(&part));
  EXPECT_TRUE(whole.endedByTime());
}

TEST(Progress, APartOfTheTimeEndsBeforeTheWhole) {
  Progress whole;
  PartOfTime unbounded(&whole, 0.5), ofNone(nullptr, 0.5);
  EXPECT_FALSE(outOfTime(&unbounded, 1e9));
  EXPECT_FALSE(outOfTime(&ofNone, 1e9));
  whole.setSecondsLeft(1000);
  PartOfTime half(&whole, 0.5);
  EXPECT_FALSE(outOfTime(&half, 400));
  EXPECT_TRUE(outOfTime(&half, 600));
  EXPECT_TRUE(whole.endedByTime());
  EXPECT_FALSE(outOfTime(&whole, 600));
  whole.cancel();
  EXPECT_TRUE(half.cancelled());
}

}  // namespace
}  // namespace innermap
