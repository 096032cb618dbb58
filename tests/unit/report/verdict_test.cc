#include "report/verdict.h"

#include <gtest/gtest.h>

#include "field/affine_map.h"
#include "innermap/core/error.h"
#include "mesh/shapes.h"

namespace innermap {
namespace {

MappedSolid mapOf(double p99, double tolerance) {
  const Mesh ball = shapes::icosphere(1);
  Facts facts = factsOf({.p99 = p99});
  for (const auto& fact : factsOfTolerance(tolerance, p99, p99 <= tolerance)) facts.push_back(fact);
  MappedSolid out{test::affineMap(test::kIdentity), makeBoundaryPair(ball, ball), facts, {}};
  out.injectivity.inside.checked = 1000;
  return out;
}

const ReportFinding& findingOf(const Verdict& verdict, const std::string& name) {
  for (const VerdictFinding& f : verdict.findings)
    if (f.finding.name == name) return f.finding;
  throw Error("no finding " + name);
}

Verdict judged(const MappedSolid& mapped, MapOrigin origin = MapOrigin::related) {
  return judgeMap(mapped, nullptr, {}, origin);
}

TEST(Verdict, OfAGoodMapEachFindingIsMet) {
  const Verdict verdict = judged(mapOf(5e-4, 1e-3));
  ASSERT_EQ(verdict.findings.size(), 4u);
  for (const VerdictFinding& f : verdict.findings) {
    EXPECT_TRUE(f.finding.met) << f.finding.name;
    EXPECT_TRUE(f.finding.advice.empty());
  }
}

TEST(Verdict, SharesOverTheirThresholdsAreNotMet) {
  MappedSolid mapped = mapOf(2e-3, 1e-3);
  mapped.injectivity.inside.folded = 2;
  mapped.injectivity.outside = 3e-3;
  mapped.injectivity.target.pairs = 1;
  const Verdict verdict = judged(mapped);
  EXPECT_DOUBLE_EQ(findingOf(verdict, "folds").value, 2e-3);
  for (const char* name : {"boundary", "folds", "outside", "self_intersections"}) {
    EXPECT_FALSE(findingOf(verdict, name).met) << name;
    EXPECT_FALSE(findingOf(verdict, name).advice.empty()) << name;
  }
  const Verdict allowed =
      judgeMap(mapped, nullptr, {.maxFolded = 2e-3, .maxOutside = 3e-3, .maxCrossings = 1},
               MapOrigin::related);
  for (const char* name : {"folds", "outside", "self_intersections"})
    EXPECT_TRUE(findingOf(allowed, name).met) << name;
}

// What crosses is the source's image on the mesh, where there is nothing to repair.
TEST(Verdict, OfASourceLaidOntoATargetItsImageCrosses) {
  MappedSolid mapped = mapOf(5e-4, 1e-3);
  mapped.injectivity.target.pairs = 1;
  const auto crossings = [&](MapOrigin origin) {
    return findingOf(judged(mapped, origin), "self_intersections");
  };
  EXPECT_NE(crossings(MapOrigin::laidOn).statement.find("as laid onto"), std::string::npos);
  EXPECT_EQ(crossings(MapOrigin::laidOn).advice.find("repair"), std::string::npos);
  EXPECT_EQ(crossings(MapOrigin::related).statement.find("as laid onto"), std::string::npos);
  EXPECT_NE(crossings(MapOrigin::related).advice.find("repair"), std::string::npos);
}

TEST(Verdict, WhereAllStepsWereTakenMoreAreAdvised) {
  MappedSolid mapped = mapOf(5e-4, 1e-3);
  mapped.injectivity.inside.folded = 500;
  const HarmonicMap step = mapped.map.steps().front();
  mapped.map = ComposedMap(std::vector<HarmonicMap>(4, step));
  const auto advice = [&](int maxSteps, OneToOne oneToOne = OneToOne::automatic) {
    const FitMapSettings fitted{.oneToOne = oneToOne, .maxSteps = maxSteps};
    return findingOf(judgeMap(mapped, nullptr, {}, MapOrigin::laidOn, fitted), "folds").advice;
  };
  EXPECT_NE(advice(4).find("more --max-steps than 4"), std::string::npos) << advice(4);
  EXPECT_EQ(advice(5).find("--max-steps"), std::string::npos) << advice(5);
  EXPECT_EQ(advice(4, OneToOne::off).find("--max-steps"), std::string::npos);
}

// The fit has told of a tolerance that it missed; a map from a file has not.
TEST(Verdict, WhatWasToldIsNotWarnedOfAgain) {
  const MappedSolid mapped = mapOf(2e-3, 1e-3);
  EXPECT_TRUE(judged(mapped).findings.front().told);
  EXPECT_FALSE(judged(mapped, MapOrigin::file).findings.front().told);
}

// What voxels say counts where it is more than points say.
TEST(Verdict, FoldsAreTheLargerShareOfPointsAndVoxels) {
  MappedSolid mapped = mapOf(5e-4, 1e-3);
  SolidGrids grids{.injectivity = mapped.injectivity};
  grids.injectivity.inside.folded = 1;
  grids.values.interiorVoxels = 1000;
  grids.values.foldedVoxels = 5;
  grids.outsideFraction = 0.25;
  const Verdict verdict = judgeMap(mapped, &grids, {}, MapOrigin::related);
  EXPECT_DOUBLE_EQ(findingOf(verdict, "folds").value, 5e-3);
  EXPECT_DOUBLE_EQ(findingOf(verdict, "outside").value, 0.25);
}

TEST(Verdict, OfFramesTheWorstIsNamed) {
  EXPECT_TRUE(judgeFrames({}, 1e-3, {}).findings.empty());
  const std::vector<JudgedFrame> frames = {
      {7, 5e-4, 0, 0}, {8, 3e-3, 0.25, 0}, {12, 2e-3, 0.125, 0.5}};
  const Verdict verdict = judgeFrames(frames, 1e-3, {});
  EXPECT_DOUBLE_EQ(findingOf(verdict, "boundary").value, 3e-3);
  EXPECT_NE(findingOf(verdict, "boundary").statement.find("2 of 3 frames"), std::string::npos);
  EXPECT_NE(findingOf(verdict, "folds").statement.find("frame 8"), std::string::npos);
  EXPECT_NE(findingOf(verdict, "outside").statement.find("frame 12"), std::string::npos);
  EXPECT_TRUE(findingOf(judgeFrames({frames[0]}, 1e-3, {}), "boundary").met);
}

TEST(Verdict, DensitiesMayGrowAsTheVolumesShrink) {
  const auto met = [&](double growth, double volumes) {
    return judgeDensity({"smoke", "", growth, volumes}, {}).findings.front().finding.met;
  };
  EXPECT_TRUE(met(5, 1));
  EXPECT_FALSE(met(7, 1));
  EXPECT_TRUE(met(7, 0.5));
}

TEST(Verdict, TexturesAreJudgedWhereTheyWereMeasured) {
  BoundaryError error;
  EXPECT_TRUE(judgeTexture(error, 0.01).findings.empty());
  error.samples = 100;
  error.p99 = 0.02;
  EXPECT_FALSE(judgeTexture(error, 0.01).findings.front().finding.met);
  EXPECT_TRUE(judgeTexture(error, 0.05).findings.front().finding.met);
}

}  // namespace
}  // namespace innermap
