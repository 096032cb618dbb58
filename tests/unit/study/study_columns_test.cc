#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "innermap/study/study.h"

namespace innermap {
namespace {

double column(const std::string& name, const Study& study, const StudyRow& row) {
  for (const StudyColumn& c : studyColumns())
    if (c.name == name) return valueOf(c, study, row);
  ADD_FAILURE() << name;
  return 0;
}

TEST(StudyColumns, HaveThePapersRatios) {
  Study study{.vertices = 500, .spacing = 2};
  StudyRow row;
  row.sources = 250;
  row.points = 1000;
  row.at = 0.05;
  row.rms = 1e-3;
  EXPECT_NEAR(column("s_ratio", study, row), 0.5, 1e-12);
  EXPECT_NEAR(column("c_ratio", study, row), 2, 1e-12);
  EXPECT_NEAR(column("o_distance", study, row), 0.05, 1e-12);
  EXPECT_NEAR(column("spacings", study, row), 0.05 / 2 * std::sqrt(250.0), 1e-12);
  EXPECT_TRUE(std::isnan(column("r_ratio", study, row)));
  EXPECT_NEAR(column("rms", study, row), 1e-3, 1e-15);
  row.failure = "no room";
  EXPECT_TRUE(std::isnan(column("rms", study, row)));
  EXPECT_NEAR(column("sources", study, row), 250, 1e-12);
}

}  // namespace
}  // namespace innermap
