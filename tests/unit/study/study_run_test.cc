#include <gtest/gtest.h>

#include "innermap/study/study.h"

namespace innermap {
namespace {

constexpr ChargePlacement kOffset = ChargePlacement::offset, kSphere = ChargePlacement::sphere;

TEST(StudyRun, BoundaryPoints) {
  EXPECT_EQ(collocationOf({100, 3, kOffset, 0.1}), 300u);
  EXPECT_EQ(collocationOf({100, 1.234, kOffset, 0.1}), 123u);
  EXPECT_EQ(collocationOf({100, 1, kOffset, 0.1}), 104u);  // no fewer than there are unknowns
}

TEST(StudyRun, SameIsTheSameFit) {
  const StudyRun run{100, 3, kOffset, 0.1};
  EXPECT_TRUE(sameRun(run, {100, 3, kOffset, 0.1 * (1 + 1e-13)}));
  EXPECT_TRUE(sameRun({100, 1, kOffset, 0.1}, {100, 1.03, kOffset, 0.1}));  // both 104 points
  EXPECT_FALSE(sameRun(run, {101, 3, kOffset, 0.1}));
  EXPECT_FALSE(sameRun(run, {150, 2, kOffset, 0.1}));  // as many points
  EXPECT_FALSE(sameRun(run, {100, 2, kOffset, 0.1}));
  EXPECT_FALSE(sameRun(run, {100, 3, kSphere, 0.1}));
  EXPECT_FALSE(sameRun(run, {100, 3, kOffset, 0.1001}));
}

}  // namespace
}  // namespace innermap
