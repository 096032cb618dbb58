#include <gtest/gtest.h>

#include "innermap/core/error.h"
#include "innermap/fit/fit_map.h"

namespace innermap {
namespace {

TEST(FitChoices, AToleranceUnlessChargesAreCounted) {
  FitChoices choices;
  EXPECT_FALSE(choices.settings(false).shell);
  EXPECT_DOUBLE_EQ(choices.settings(false).tolerance, 1e-3);
  EXPECT_DOUBLE_EQ(choices.settings(true).tolerance, kLaidOnTolerance);
  choices.tolerance = 1e-4;
  EXPECT_DOUBLE_EQ(choices.settings(true).tolerance, 1e-4);
  choices.fit.maxSteps = 3;
  EXPECT_EQ(choices.settings(true).maxSteps, 3);
}

TEST(FitChoices, WhatPlacesANumberOfChargesMakesAShell) {
  FitChoices choices;
  choices.shell.distance = 0.1;
  EXPECT_EQ(choices.settings(false).shell->sources, ShellSettings{}.sources);
  choices.sources = 400;
  choices.collocation = 1600;
  const FitMapSettings made = choices.settings(false);
  EXPECT_EQ(made.shell->sources, 400u);
  EXPECT_EQ(made.shell->collocation, 1600u);
  EXPECT_DOUBLE_EQ(*made.shell->distance, 0.1);
}

TEST(FitChoices, WhatExcludesOneAnotherIsRefused) {
  const auto refused = [](auto change) {
    FitChoices choices;
    change(choices);
    EXPECT_THROW(choices.settings(false), SettingError);
  };
  using C = FitChoices;
  refused([](C& c) { c.tolerance = 1e-3, c.sources = 100; });
  refused([](C& c) { c.tolerance = 1e-3, c.shell.method = Regularization::truncatedSvd; });
  refused([](C& c) { c.shell.distance = 0.1, c.shell.radiusRatio = 2; });
  refused([](C& c) { c.sources = 100, c.collocation = 103; });
  refused([](C& c) { c.sources = 100, c.fit.oneToOne = OneToOne::on; });
  refused([](C& c) { c.tolerance = 1e-13; });
  refused([](C& c) { c.tolerance = 2; });
  refused([](C& c) { c.shell.radiusRatio = 1; });
  refused([](C& c) { c.fit.maxSteps = 0; });
  refused([](C& c) { c.fit.maxSources = 999; });
}

}  // namespace
}  // namespace innermap
