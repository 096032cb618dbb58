#include "report/report.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "innermap/core/error.h"
#include "io/test_files.h"

namespace innermap {
namespace {

using Json = nlohmann::json;

Figures solve(double regularization) {
  return {{"method", "tsvd", "method"},
          {"sources", std::size_t(100), "charges"},
          {"regularization", regularization, "regularisation"}};
}

Report full() {
  Report r{.command = "map"};
  r.add("solve", solve(1e-10));
  r.seconds = {{"read", 0.1}, {"solve", 1.5}};
  r.peakMemory = 123456789;
  return r;
}

TEST(Report, HasFiguresInTheirSections) {
  Report r = full();
  r.add("", {{"dry_run", true, "dry run"}});
  r.add("new", under("section", "", {{"names", std::vector<std::string>{"a", "b"}, "names"}}));
  const Json j = Json::parse(reportJson(r));
  EXPECT_EQ(j.at("solve").at("method"), "tsvd");
  EXPECT_EQ(j.at("solve").at("sources"), 100);
  EXPECT_EQ(j.at("dry_run"), true);
  EXPECT_EQ(j.at("new").at("section").at("names").at(1), "b");
  EXPECT_EQ(j.at("seconds").at("solve"), 1.5);
  EXPECT_EQ(j.at("peak_memory_bytes"), 123456789);
}

TEST(Report, SaysWhatRanAndHowItIsJudged) {
  Report r = full();
  r.run = ReportRun{"1.2.3", {"innermap", "map"}, "2026-01-31T23:59:59Z", 4, 2, {}};
  r.run->settings = {{"tolerance", 1e-3}, {"sources", std::nan("")}};
  r.verdict = {{"boundary", "near enough", 1e-4, 1e-3, true, ""},
               {"folds", "folded", 0.1, 0.0, false, "unfold it"}};
  r.outputs = {{"out/map.ply", 1234}};
  const Json j = Json::parse(reportJson(r));
  EXPECT_EQ(j.at("version"), "1.2.3");
  EXPECT_EQ(j.at("host").at("threads"), 2);
  EXPECT_EQ(j.at("settings").at("tolerance"), 1e-3);
  EXPECT_TRUE(j.at("settings").at("sources").is_null());
  EXPECT_EQ(j.at("verdict").at("met"), false);
  EXPECT_EQ(j.at("verdict").at("findings").at(1).at("advice"), "unfold it");
  EXPECT_FALSE(j.at("verdict").at("findings").at(0).contains("advice"));
  EXPECT_EQ(j.at("outputs").at(0).at("bytes"), 1234);
}

TEST(Report, LeavesOutWhatWasNotComputed) {
  const Json j = Json::parse(reportJson({.command = "check"}));
  EXPECT_FALSE(j.contains("solve"));
  EXPECT_FALSE(j.contains("target"));
  EXPECT_TRUE(j.contains("seconds"));
}

TEST(Report, NumbersThatAreNotFiniteAreNullAndUnknownOnesAreLeftOut) {
  Report r = full();
  r.add("solve", solve(std::nan("")));
  r.add("list", {{"numbers", std::vector<double>{1, -INFINITY}, "numbers"},
                 {"unknown", std::optional<double>(), "unknown"}});
  const Json j = Json::parse(reportJson(r));
  EXPECT_TRUE(j["solve"]["regularization"].is_null());
  EXPECT_TRUE(j["list"]["numbers"][1].is_null());
  EXPECT_FALSE(j["list"].contains("unknown"));
}

TEST(Report, LaterFiguresWin) {
  Report r = full();
  r.add("solve", solve(1e-3));
  EXPECT_EQ(Json::parse(reportJson(r))["solve"]["regularization"], 1e-3);
}

TEST(Report, IsWrittenWholeAndSurvivesOddPaths) {
  const test::TemporaryFolder folder;
  Report r = full();
  r.add("source", {{"path", "a\xff\"\n.obj", "file"}});
  writeReport(folder.file("r.json"), r);
  EXPECT_EQ(Json::parse(test::contents(folder.file("r.json"))).at("command"), "map");
  EXPECT_EQ(folder.count(), 1u);
  EXPECT_THROW(writeReport(folder.file("missing/r.json"), r), FileError);
}

}  // namespace
}  // namespace innermap
