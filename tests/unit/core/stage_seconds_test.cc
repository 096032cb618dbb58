#include <gtest/gtest.h>

#include <stdexcept>

#include "innermap/core/run.h"

namespace innermap {
namespace {

TEST(StageSeconds, AddsUpByStageInTheOrderOfFirstUse) {
  StageSeconds stages;
  addSeconds(stages, "read", 1);
  addSeconds(stages, "fit", 2);
  addSeconds(stages, StageSeconds{{"read", 0.5}, {"write", 4}});
  EXPECT_EQ(stages, (StageSeconds{{"read", 1.5}, {"fit", 2}, {"write", 4}}));
}

TEST(StageSeconds, TimesABodyAndGivesItsResult) {
  StageSeconds stages;
  EXPECT_EQ(timed(stages, "fit", [] { return 42; }), 42);
  timed(stages, "write", [] {});
  ASSERT_EQ(stages.size(), 2u);
  EXPECT_EQ(stages[1].first, "write");
  EXPECT_GE(stages[0].second, 0);
}

TEST(StageSeconds, WhatFailsIsNotCounted) {
  StageSeconds stages;
  EXPECT_THROW(timed(stages, "fit", [] { throw std::runtime_error("no"); }), std::runtime_error);
  EXPECT_TRUE(stages.empty());
}

}  // namespace
}  // namespace innermap
