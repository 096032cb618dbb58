#include <gtest/gtest.h>

#include "innermap/core/error.h"
#include "innermap/levelset/level_set.h"

namespace innermap {
namespace {

TEST(LatticeChoice, WhatIsNotChosenStays) {
  const LevelSetSettings settings{.resolution = 40};
  EXPECT_EQ(LatticeChoice{}.in(settings).resolution, 40);
  LatticeChoice choice{.resolution = 64};
  EXPECT_EQ(choice.in(settings).resolution, 64);
  EXPECT_EQ(choice.in(settings).voxelSize, 0);
  choice.voxelSize = 0.5;
  EXPECT_EQ(choice.in<LevelSetSettings>().voxelSize, 0.5);
}

TEST(LatticeChoice, IsOutOfRangeWhereTheLevelSetIs) {
  LatticeChoice choice;
  for (const int bad : {kLeastVoxels - 1, kMostVoxels + 1}) {
    choice.resolution = bad;
    EXPECT_THROW(requireInRange(describe(choice)), SettingError);
  }
  choice = {};
  choice.voxelSize = 0;
  EXPECT_THROW(requireInRange(describe(choice)), SettingError);
  choice.voxelSize = 1e-3;
  EXPECT_NO_THROW(requireInRange(describe(choice)));
}

TEST(LatticeChoice, HelpSaysOfWhatAndWhatIsUsual) {
  LatticeChoice choice;
  const auto settings = describe(choice, "each solid", "as the grids");
  EXPECT_NE(settings[0].help.find("each solid"), std::string::npos);
  EXPECT_EQ(settings[0].fallback, "as the grids");
  EXPECT_NE(describe(choice)[0].fallback.find(std::to_string(kUsualResolution)), std::string::npos);
}

}  // namespace
}  // namespace innermap
