#include "job_clock.h"

#include <gtest/gtest.h>

namespace innermap::tool {
namespace {

std::vector<JobPhase> steadyThenDoubtful(double doubtful) {
  return {{.stage = "steady", .seconds = 10},
          {.stage = "doubtful", .seconds = doubtful, .doubtful = doubtful}};
}

TEST(JobClockRelease, HidesATimeThatIsMostlyDoubtful) {
  EXPECT_EQ(tellableSeconds(steadyThenDoubtful(9)), 19);
  EXPECT_EQ(tellableSeconds(steadyThenDoubtful(11)), 0);
  std::vector<JobPhase> perhaps = steadyThenDoubtful(11);
  perhaps.back().perhaps = true;
  EXPECT_EQ(tellableSeconds(perhaps), 10);
}

TEST(JobClockRelease, ShowsTheTimeLeftOnceItCanBeTold) {
  for (const double doubtful : {3.0, 30.0}) {
    JobClock clock;
    clock.expect(steadyThenDoubtful(doubtful), 0);
    clock.report("steady", 0.5, 5);
    EXPECT_EQ(clock.at(5).tellsTime, doubtful < 5);
    clock.report("doubtful", 0.01, 10);
    EXPECT_FALSE(clock.at(10.5).tellsTime);
    // What a stage has reported itself is trusted.
    clock.report("doubtful", 0.5, 10 + doubtful / 2);
    EXPECT_TRUE(clock.at(10 + doubtful / 2).tellsTime);
  }
}

}  // namespace
}  // namespace innermap::tool
