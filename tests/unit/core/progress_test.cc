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

TEST(Progress, ReportsArrive) {
  struct Recorder : Progress {
    void report(std::string_view stage, double fraction) override {
      last = std::string(stage) + " " + std::to_string(fraction);
    }
    std::string last;
  } recorder;
  reportProgress(&recorder, "placing", 0.5);
  EXPECT_EQ(recorder.last, "placing 0.500000");
}

}  // namespace
}  // namespace innermap
