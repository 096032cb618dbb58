#include "report/schema.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "innermap/core/error.h"

namespace innermap {
namespace {

using Json = nlohmann::json;

std::vector<ReportSection> sections() {
  return {{"error",
           "Error",
           "How far off.",
           {{"p99", 0.5, "99% within", "are nearer", FigureUnit::diagonals},
            {"share", 0.5, "share", "", FigureUnit::share},
            {"part.count", std::size_t(1), "count"}},
           {"p99"}},
          {"mass", "Mass", "", {{"*_before", 1.0, "*, before"}}, {}},
          {"", "", "", {{"dry_run", true, "dry run", "nothing was done"}}, {}}};
}

TEST(ReportSchema, HasAnObjectASectionWithTypesAndWords) {
  const Json root = Json::parse(reportSchema(sections()))["properties"];
  const Json& error = root["error"];
  EXPECT_EQ(error["description"], "How far off.");
  EXPECT_EQ(error["required"], Json({"p99"}));
  EXPECT_EQ(error["additionalProperties"], false);
  EXPECT_EQ(error["properties"]["p99"]["description"],
            "99% within: are nearer (fraction of the diagonal)");
  EXPECT_EQ(error["properties"]["p99"]["$ref"], "#/$defs/number");
  EXPECT_EQ(error["properties"]["share"]["$ref"], "#/$defs/share");
  EXPECT_EQ(error["properties"]["part"]["properties"]["count"]["$ref"], "#/$defs/count");
  EXPECT_EQ(root["dry_run"]["type"], "boolean");
  EXPECT_TRUE(root.contains("outputs"));
}

TEST(ReportSchema, NamesOfTheInputArePatterns) {
  const Json mass = Json::parse(reportSchema(sections()))["properties"]["mass"];
  EXPECT_TRUE(mass["patternProperties"].contains("^.+_before$"));
}

TEST(ReportSchema, RefusesTwoFiguresOfOneKey) {
  const Figure twice("p99", 0.5, "99%");
  EXPECT_THROW(reportSchema({{"error", "", "", {twice, twice}, {}}}), Error);
}

TEST(ReportWords, SayHowFiguresAreWritten) {
  const Json words = Json::parse(reportWords(sections()));
  EXPECT_EQ(words["sections"][0], Json({"error", "Error", "How far off."}));
  EXPECT_EQ(words["figures"]["error.share"], Json({"share", "", "share"}));
  EXPECT_EQ(words["figures"]["error.p99"][2], "error");
  EXPECT_EQ(words["figures"]["dry_run"][1], "nothing was done");
}

}  // namespace
}  // namespace innermap
