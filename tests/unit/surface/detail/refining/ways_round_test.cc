#include "surface/detail/refining/ways_round.h"

#include <gtest/gtest.h>

#include <cmath>

#include "innermap/core/error.h"
#include "surface/detail/sphere/rotation_search.h"

namespace innermap {
namespace {

// Places all over a body that is longer than wide.
Points body() {
  Points out;
  for (int i = 0; i < 60; ++i)
    out.push_back({std::cos(1.7 * i), 3 * std::sin(0.9 * i), 0.5 * std::cos(2.3 * i + 1)});
  return out;
}

// The body laid on itself, turned by so many degrees about its long side.
JudgedMap turned(double degrees, double score) {
  Points images;
  const Mat3 rotation = rotationAbout({0, degrees * std::acos(-1.0) / 180, 0});
  for (const Vec3& p : body()) images.push_back(rotation * p + Vec3{5, 6, 7});
  MapJudge judge{.score = [score](const Points&) { return score; }};
  return judgedMap(judge, body(), std::move(images));
}

TEST(WaysRound, TurnsAreThoseOfTheRotations) {
  for (const double degrees : {0.0, 30.0, 90.0, 179.0})
    EXPECT_NEAR(degreesOf(turned(degrees, 1).turn), degrees, 1e-6);
}

TEST(WaysRound, OfThoseAsGoodTheOneThatTurnsLeastComesFirst) {
  EXPECT_EQ(byPreference({turned(180, 1.0), turned(0, 1.05), turned(90, 3)}),
            (std::vector<std::size_t>{1, 0, 2}));
  EXPECT_EQ(byPreference({turned(0, 1.5), turned(180, 1.0)}), (std::vector<std::size_t>{1, 0}));
  // Of one way the better score counts alone.
  EXPECT_EQ(byPreference({turned(3, 1.0), turned(0, 1.05)}), (std::vector<std::size_t>{0, 1}));
  EXPECT_TRUE(byPreference({}).empty());
}

TEST(WaysRound, AreNumberedInOrder) {
  EXPECT_EQ(waysOf({turned(0, 1), turned(180, 1.1), turned(2, 1.2), turned(90, 2)}),
            (std::vector<std::size_t>{0, 1, 0, 2}));
}

TEST(WaysRound, AreChosenByNumberOrMirrored) {
  const std::vector<JudgedMap> maps{turned(0, 1), turned(60, 1.1), turned(178, 2)};
  const std::vector<std::size_t> ways = waysOf(maps);
  const auto wanted = [&](int choose, bool mirror) {
    return wantedWay(maps, ways, {choose, mirror}, "a body");
  };
  EXPECT_EQ(wanted(1, false), 0u);
  EXPECT_EQ(wanted(3, false), 2u);
  EXPECT_EQ(wanted(1, true), 2u);
  EXPECT_THROW(wanted(4, false), SettingError);
  EXPECT_THROW(wanted(0, false), SettingError);
  EXPECT_THROW(wantedWay({maps[0], maps[1]}, {0, 1}, {1, true}, "a body"), SettingError);
}

}  // namespace
}  // namespace innermap
