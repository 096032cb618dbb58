#include "innermap/io/report.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "innermap/core/error.h"
#include "io/test_files.h"

namespace innermap {
namespace {

using Json = nlohmann::json;

Report full() {
  Report r;
  r.command = "map";
  r.source = ReportMesh{"a.obj", 10, 16, 2, 2, 1, 0.5, 1.7};
  r.target = ReportMesh{"b.obj", 10, 16, 2, 2, 1, 0.6, 1.8};
  r.solve = ReportSolve{"svd", 100, 400, 98, 1e-10, 0};
  r.boundaryError = ReportBoundaryError{1e-4, 3e-4, 1e-3, 20000, 2e-5};
  r.energy = ReportEnergy{3.1, 0.01};
  r.jacobian = ReportJacobian{-0.1, 2.5, 1e-4};
  r.grid = ReportGrid{0.01, 5000, 4000};
  r.seconds = {{"read", 0.1}, {"solve", 1.5}};
  r.peakMemory = 123456789;
  return r;
}

TEST(Report, HasEveryKeyOfTheContract) {
  const Json j = Json::parse(reportJson(full()));
  for (const char* mesh : {"source", "target"})
    for (const char* key :
         {"path", "vertices", "triangles", "boundary_loops", "caps", "genus", "volume", "diagonal"})
      EXPECT_TRUE(j.at(mesh).contains(key)) << mesh << key;
  for (const char* key :
       {"method", "sources", "collocation", "rank", "regularization", "iterations"})
    EXPECT_TRUE(j.at("solve").contains(key)) << key;
  for (const char* key : {"rms", "p99", "max", "samples", "c_error"})
    EXPECT_TRUE(j.at("boundary_error").contains(key)) << key;
  EXPECT_EQ(j.at("energy").at("harmonic"), 3.1);
  EXPECT_EQ(j.at("energy").at("deformation"), 0.01);
  EXPECT_EQ(j.at("jacobian").at("folded_fraction"), 1e-4);
  EXPECT_EQ(j.at("jacobian").at("min"), -0.1);
  EXPECT_EQ(j.at("jacobian").at("max"), 2.5);
  EXPECT_EQ(j.at("grid").at("voxel_size"), 0.01);
  EXPECT_EQ(j.at("grid").at("active_voxels"), 5000);
  EXPECT_EQ(j.at("grid").at("interior_voxels"), 4000);
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
  Report r;
  r.command = "check";
  const Json j = Json::parse(reportJson(r));
  EXPECT_FALSE(j.contains("solve"));
  EXPECT_FALSE(j.contains("target"));
  EXPECT_TRUE(j.contains("seconds"));
}

TEST(Report, NumbersThatAreNotFiniteAreNull) {
  Report r = full();
  r.energy->deformation = std::nan("");
  r.jacobian->max = INFINITY;
  r.set("list", std::vector<double>{1, -INFINITY});
  const Json j = Json::parse(reportJson(r));
  EXPECT_TRUE(j["energy"]["deformation"].is_null());
  EXPECT_TRUE(j["jacobian"]["max"].is_null());
  EXPECT_TRUE(j["list"][1].is_null());
}

TEST(Report, FurtherKeysGoIntoSections) {
  Report r = full();
  r.set("solve.distance", 0.05);
  r.set("new.section.deep", true);
  r.set("new.section.names", std::vector<std::string>{"a", "b"});
  r.set("solve.distance", 0.06);
  r.set("new.count", std::size_t(7));
  r.setColumn("new.squares", std::vector<int>{2, 3}, [](int n) { return n * n; });
  const Json j = Json::parse(reportJson(r));
  EXPECT_EQ(j["new"]["count"], 7);
  EXPECT_EQ(j["new"]["squares"], Json({4.0, 9.0}));
  EXPECT_EQ(j["solve"]["distance"], 0.06);
  EXPECT_EQ(j["solve"]["sources"], 100);
  EXPECT_EQ(j["new"]["section"]["deep"], true);
  EXPECT_EQ(j["new"]["section"]["names"][1], "b");
}

TEST(Report, IsWrittenWholeAndSurvivesOddPaths) {
  const test::TemporaryFolder folder;
  Report r = full();
  r.source->path = "a\xff\"\n.obj";
  writeReport(folder.file("r.json"), r);
  EXPECT_EQ(Json::parse(test::contents(folder.file("r.json"))).at("command"), "map");
  EXPECT_EQ(folder.count(), 1u);
  EXPECT_THROW(writeReport(folder.file("missing/r.json"), r), FileError);
}

}  // namespace
}  // namespace innermap
