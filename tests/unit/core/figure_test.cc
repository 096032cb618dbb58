#include "core/figure.h"

#include <gtest/gtest.h>

#include <cmath>

#include "innermap/core/error.h"

namespace innermap {
namespace {

struct Row {
  std::string name;
  std::optional<double> error;
  int count = 0;
};

Figures figuresOf(const Row& r) {
  return {{"name", r.name, "names", ""},
          {"error", r.error, "errors", "99% within", FigureUnit::diagonals},
          {"count", r.count, "counts", ""}};
}

std::vector<double> numbers(const Figures& figures, const char* key) {
  return std::get<std::vector<double>>(findFigure(figures, key)->value);
}

TEST(Figure, HasTheTypeOfItsValueAlsoWhereNothingIsKnown) {
  const Figure count("count", std::size_t(3), "count"), whole("whole", -2, "whole"),
      number("number", 0.5, "number"), flag("flag", true, "flag"), text("text", "word", "text"),
      place("place", Vec3{1, 2, 3}, "place"), unknown("unknown", std::optional<double>(), "none");
  EXPECT_EQ(std::get<std::uint64_t>(count.value), 3u);
  EXPECT_EQ(std::get<std::int64_t>(whole.value), -2);
  EXPECT_TRUE(std::get<bool>(flag.value));
  EXPECT_EQ(std::get<std::string>(text.value), "word");
  EXPECT_EQ(std::get<std::vector<double>>(place.value), (std::vector<double>{1, 2, 3}));
  EXPECT_TRUE(std::holds_alternative<double>(unknown.value));
  EXPECT_FALSE(unknown.known);
  EXPECT_FALSE(number.when(false).known);
  EXPECT_FALSE(unknown.when(true).known);
}

TEST(Figure, IsFoundByItsKeyWhereItIsKnown) {
  const Figures all =
      together({figuresOf({"a", {}, 4}), under("part", "of it", {{"p99", 1.0, "99%"}}),
                prefixed("more_", {{"max", 2.0, "max"}})});
  EXPECT_EQ(findFigure(all, "error"), nullptr);
  EXPECT_EQ(findFigure(all, "part.p99")->name, "of it, 99%");
  EXPECT_EQ(numberOf(*findFigure(all, "more_max")), 2.0);
  const Figures two = only(all, {"count", "name"});
  ASSERT_EQ(two.size(), 2u);
  EXPECT_EQ(two[0].key, "count");
  EXPECT_THROW(only(all, {"missing"}), Error);
  EXPECT_THROW(numberOf(*findFigure(all, "name")), Error);
  EXPECT_EQ(findFigure(when(false, all), "count"), nullptr);
}

TEST(Figure, RowsBecomeColumns) {
  const std::vector<Row> rows = {{"a", 0.5, 1}, {"b", {}, 2}};
  const Figures made = columns(rows, figuresOf);
  EXPECT_EQ(std::get<std::vector<std::string>>(findFigure(made, "name")->value),
            (std::vector<std::string>{"a", "b"}));
  EXPECT_EQ(numbers(made, "error")[0], 0.5);
  EXPECT_TRUE(std::isnan(numbers(made, "error")[1]));
  EXPECT_EQ(numbers(made, "count"), (std::vector<double>{1, 2}));
  EXPECT_EQ(findFigure(made, "error")->unit, FigureUnit::diagonals);
  EXPECT_TRUE(numbers(columns(std::vector<Row>(), figuresOf), "count").empty());
  Figures other = made;
  EXPECT_THROW(addRow(other, only(figuresOf({}), {"count"})), Error);
}

TEST(Figure, UnitsHaveWords) {
  EXPECT_EQ(textOf(FigureUnit::none), "");
  EXPECT_EQ(textOf(FigureUnit::diagonals), "fraction of the diagonal");
}

}  // namespace
}  // namespace innermap
