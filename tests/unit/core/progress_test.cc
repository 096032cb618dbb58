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

}  // namespace
}  // namespace innermap
