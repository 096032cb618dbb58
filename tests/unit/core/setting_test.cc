#include "innermap/core/setting.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/expect.h"
#include "innermap/core/error.h"

namespace innermap {
namespace {

enum class Way { there, back };

struct Example {
  int count = 4;
  double size = 0;
  std::optional<double> angle;
  std::uint64_t seed = 1;
  bool keep = true;
  Way way = Way::back;
  int axis = 2;
};

std::vector<Setting> describe(Example& e) {
  return {Setting("count", "N", &e.count, "cells, unless {size} tells").from(2, 8).in("cells"),
          Setting("size", "L", &e.size, "of a cell").above(0, 1).otherwise(0, "by {count}"),
          Setting("angle", "A", &e.angle, "of edges").from(1, 179).rare(),
          seedSetting(&e.seed),
          Setting("keep", &e.keep, "let go"),
          Setting("way", "WAY", choiceOf<Way>(&e.way, {{"there", Way::there}, {"back", Way::back}}),
                  "which way"),
          axisSetting("axis", &e.axis, "across")};
}

std::string refusalOf(const Example& example) {
  return test::refusalOf<SettingError>([&] { requireDescribed(example); });
}

TEST(NumberRange, HoldsItsBoundsButNoOpenOne) {
  const NumberRange closed{1, 2}, open{1, 2, true};
  EXPECT_TRUE(closed.holds(1) && closed.holds(2) && open.holds(2));
  EXPECT_FALSE(open.holds(1) || closed.holds(0.999) || closed.holds(2.001));
  EXPECT_FALSE(closed.holds(std::nan("")));
  EXPECT_FALSE(NumberRange{}.holds(std::nan("")));
  EXPECT_FALSE(NumberRange{}.holds(std::numeric_limits<double>::infinity()));
  EXPECT_FALSE(NumberRange{}.bounded());
  EXPECT_TRUE(NumberRange{}.holds(-1e308));
}

TEST(NumberRange, SaysItself) {
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  EXPECT_EQ((NumberRange{4, 4096}).text(), "from 4 to 4096");
  EXPECT_EQ((NumberRange{0, kInfinite, true}).text(), "above 0");
  EXPECT_EQ((NumberRange{1, 100, true}).text(), "above 1 up to 100");
  EXPECT_EQ((NumberRange{2, kInfinite}).text(), "of at least 2");
  EXPECT_EQ((NumberRange{-kInfinite, 3}).text(), "of at most 3");
  EXPECT_EQ(NumberRange{}.text(), "");
  EXPECT_EQ((NumberRange{1, 2}).refusal("3", "degrees"),
            "3 is out of range; give a number from 1 to 2 (degrees)");
  EXPECT_EQ(NumberRange{}.refusal("inf", ""), "inf is out of range; give a finite number");
}

TEST(Setting, WhatIsOutOfRangeIsNamed) {
  Example e;
  EXPECT_EQ(refusalOf(e), "accepted");  // 0 is no size, but means one
  e.count = 9;
  EXPECT_EQ(refusalOf(e), "count: 9 is out of range; give a number from 2 to 8 (cells)");
  e = {};
  e.size = -0.5;
  EXPECT_EQ(refusalOf(e), "size: -0.5 is out of range; give a number above 0 up to 1");
  e = {};
  e.angle = 0;
  EXPECT_NE(refusalOf(e), "accepted");
  e.angle = 90;
  EXPECT_EQ(refusalOf(e), "accepted");
  e.seed = 2'000'000'000'000'000;
  EXPECT_NE(refusalOf(e), "accepted");
  e = {};
  e.size = std::nan("");
  EXPECT_NE(refusalOf(e), "accepted");
}

TEST(Setting, ChoicesTellAndTake) {
  Example e;
  const auto choice = std::get<SettingChoice>(only(describe(e), {"way"}).front().value);
  EXPECT_EQ(choice.words, (std::vector<std::string>{"there", "back"}));
  EXPECT_EQ(choice.now(), 1u);
  choice.take(0);
  EXPECT_EQ(e.way, Way::there);
  std::get<SettingChoice>(only(describe(e), {"axis"}).front().value).take(0);
  EXPECT_EQ(e.axis, 0);
}

TEST(Setting, ListsAreChosenFromByName) {
  Example e;
  const auto left = without(describe(e), {"seed", "keep"});
  EXPECT_EQ(left.size(), 5u);
  EXPECT_EQ(left[3].name, "way");
  EXPECT_EQ(only(describe(e), {"keep", "count"}).front().name, "count");
  EXPECT_THROW(without(describe(e), {"sead"}), Error);
  EXPECT_THROW(only(describe(e), {"sead"}), Error);
}

TEST(Setting, NamesInHelpAreShown) {
  const auto loud = [](const std::string& name) { return "<" + name + ">"; };
  EXPECT_EQ(withNames("in place of {size}, or {count}", loud), "in place of <size>, or <count>");
  EXPECT_EQ(withNames("a { brace", loud), "a { brace");
  EXPECT_EQ(withNames("", loud), "");
}

}  // namespace
}  // namespace innermap
