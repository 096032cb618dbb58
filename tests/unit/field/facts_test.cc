#include <gtest/gtest.h>

#include "innermap/field/field_file.h"

namespace innermap {
namespace {

const Facts kFacts{{"name", "1e3 cows"}, {"error", "2.5e-04"}, {"count", "12"},
                   {"met", "true"},      {"missed", "false"},  {"none", ""}};

TEST(Facts, AreReadAsWhatTheyAre) {
  EXPECT_EQ(factText(kFacts, "name"), "1e3 cows");
  EXPECT_DOUBLE_EQ(*factNumber(kFacts, "error"), 2.5e-4);
  EXPECT_DOUBLE_EQ(*factNumber(kFacts, "count"), 12);
  EXPECT_EQ(factFlag(kFacts, "met"), true);
  EXPECT_EQ(factFlag(kFacts, "missed"), false);
}

TEST(Facts, WhatIsNoneIsNothing) {
  EXPECT_FALSE(factText(kFacts, "other"));
  for (const char* key : {"other", "name", "met", "none"})
    EXPECT_FALSE(factNumber(kFacts, key)) << key;
  for (const char* key : {"other", "name", "count", "none"})
    EXPECT_FALSE(factFlag(kFacts, key)) << key;
}

TEST(Facts, TextsAreReadBack) {
  for (const double number : {0.0, -1.0 / 3, 2e-300, 1e15, 0.1})
    EXPECT_NEAR(*factNumber({{"x", textOfFact(number)}}, "x"), number, 1e-9 * std::abs(number));
  EXPECT_EQ(factFlag({{"x", textOfFact(true)}}, "x"), true);
}

}  // namespace
}  // namespace innermap
