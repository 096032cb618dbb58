#include <gtest/gtest.h>

#include <functional>

#include "innermap/study/study.h"

namespace innermap {
namespace {

using Verdict = StatementVerdict;

StudyRow rowOf(StudyRun run, double rms) {
  StudyRow row;
  static_cast<StudyRun&>(row) = run;
  row.points = collocationOf(run);
  row.rms = rms;
  row.p99 = 3 * rms;
  row.max = 5 * rms;
  row.collocationRms = rms;
  row.cError = rms * rms * static_cast<double>(row.points);
  row.folded = 0;
  row.weights = row.condition = 1;
  row.seconds = 1e-3 * static_cast<double>(run.sources);
  return row;
}

// Errors by distance (0.1, 0.05, 0.025), number (100, 200), ratio (1, 2) and radius (1.5).
Study studyOf(const std::function<double(const StudyRun&)>& error) {
  Study study{.base = {100, 2, ChargePlacement::offset, 0.05},
              .baseSphere = {100, 2, ChargePlacement::sphere, 1.5},
              .vertices = 1000,
              .spacing = 0.5};
  std::vector<StudyRun> runs{study.base, study.baseSphere};
  for (const double at : {0.1, 0.025}) runs.push_back({100, 2, ChargePlacement::offset, at});
  runs.push_back({200, 2, ChargePlacement::offset, 0.05});
  runs.push_back({100, 1, ChargePlacement::offset, 0.05});
  for (const StudyRun& run : runs) study.rows.push_back(rowOf(run, error(run)));
  return study;
}

Verdict verdictOf(const Study& study, const std::string& words) {
  for (const StudyStatement& s : studyFindings(study).statements)
    if (s.text.find(words) != std::string::npos) return s.verdict;
  ADD_FAILURE() << words;
  return Verdict::unknown;
}

double usual(const StudyRun& run) {
  if (run.placement == ChargePlacement::sphere) return 0.05;
  return run.at / static_cast<double>(run.sources) / run.collocation;
}

TEST(StudyFindings, SeriesAreSortedAndOfTheBase) {
  const Study study = studyOf(usual);
  const auto distances = studySeries(study, StudyAxis::place, ChargePlacement::offset);
  ASSERT_EQ(distances.size(), 3u);
  EXPECT_LT(distances[0].at, distances[1].at);
  EXPECT_LT(distances[1].at, distances[2].at);
  EXPECT_EQ(studySeries(study, StudyAxis::sources, ChargePlacement::offset).size(), 2u);
  EXPECT_EQ(studySeries(study, StudyAxis::collocation, ChargePlacement::offset).size(), 2u);
  EXPECT_EQ(studySeries(study, StudyAxis::place, ChargePlacement::sphere).size(), 1u);
}

TEST(StudyFindings, StatementsHold) {
  const Study study = studyOf(usual);
  EXPECT_EQ(verdictOf(study, "smaller error at fresh points"), Verdict::holds);
  EXPECT_EQ(verdictOf(study, "smaller C-Error"), Verdict::holds);
  EXPECT_EQ(verdictOf(study, "on a sphere"), Verdict::holds);
  EXPECT_EQ(verdictOf(study, "More charges"), Verdict::holds);
  EXPECT_EQ(verdictOf(study, "More boundary points"), Verdict::holds);
  EXPECT_EQ(verdictOf(study, "too near"), Verdict::fails);  // the nearest is the best here
}

TEST(StudyFindings, StatementsFail) {
  const Study study = studyOf([](const StudyRun& run) {
    return run.placement == ChargePlacement::sphere ? 1e-9 : 1e-3 / usual(run);
  });
  EXPECT_EQ(verdictOf(study, "smaller error at fresh points"), Verdict::fails);
  EXPECT_EQ(verdictOf(study, "on a sphere"), Verdict::fails);
  EXPECT_EQ(verdictOf(study, "More charges"), Verdict::fails);
  EXPECT_EQ(verdictOf(study, "More boundary points"), Verdict::fails);
}

TEST(StudyFindings, InPartAndUnknown) {
  Study study = studyOf([](const StudyRun& run) { return run.at < 0.03 ? 0.1 : usual(run); });
  EXPECT_EQ(verdictOf(study, "smaller error at fresh points"), Verdict::partly);
  EXPECT_EQ(verdictOf(study, "too near"), Verdict::partly);
  for (StudyRow& row : study.rows)
    if (row.at < 0.03) row.collocationRms = 0.01 * row.rms;
  EXPECT_EQ(verdictOf(study, "too near"), Verdict::holds);
  study.rows.resize(1);
  for (const StudyStatement& s : studyFindings(study).statements)
    EXPECT_EQ(s.verdict, Verdict::unknown) << s.text;
}

TEST(StudyFindings, BestAndCheapest) {
  Study study = studyOf(usual);
  StudyFindings found = studyFindings(study);
  ASSERT_TRUE(found.best);
  EXPECT_LE(found.best->p99 / 3, 0.05 / 200 / 2 + 1e-12);
  // One that is nearly as good in a tenth of the time.
  study.rows[0].p99 = 1.4 * found.best->p99;
  study.rows[0].seconds = 1e-3;
  found = studyFindings(study);
  EXPECT_TRUE(sameRun(*found.cheapest, study.rows[0]));
  EXPECT_FALSE(found.advice.empty());
  // Rows without a map are not counted.
  for (StudyRow& row : study.rows) row.failure = "no room";
  found = studyFindings(study);
  EXPECT_FALSE(found.best);
  EXPECT_TRUE(found.advice.empty());
}

TEST(StudyFindings, SaysWhatTheCErrorHides) {
  Study study = studyOf(usual);
  const auto says = [&](const std::string& words) {
    for (const std::string& text : studyFindings(study).advice)
      if (text.find(words) != std::string::npos) return true;
    return false;
  };
  EXPECT_TRUE(says("C-Error can be trusted"));
  study.rows.back().collocationRms = 0.1 * study.rows.back().rms;
  EXPECT_TRUE(says("C-Error misleads in 1 of 6 runs"));
}

TEST(StudyFindings, Words) {
  const StudyRun offset{1000, 4, ChargePlacement::offset, 0.02},
      sphere{500, 1, ChargePlacement::sphere, 1.5};
  EXPECT_EQ(describeRun(offset), "1000 charges at 0.02, 4 points each");
  EXPECT_NE(describeRun(sphere).find("sphere of 1.5"), std::string::npos);
  EXPECT_EQ(optionsOf(offset, {}),
            "--charges 1000 --collocation 4000 --distance 0.02 --solver dense --interpolation "
            "linear --seed 1");
  EXPECT_NE(optionsOf(sphere, {.method = Regularization::truncatedSvd, .regularization = 1e-6})
                .find("--radius-ratio 1.5"),
            std::string::npos);
  EXPECT_NE(optionsOf(sphere, {.method = Regularization::truncatedSvd, .regularization = 1e-6})
                .find("--method tsvd --regularization 1e-06"),
            std::string::npos);
  EXPECT_EQ(verdictText(Verdict::partly), "in part");
}

}  // namespace
}  // namespace innermap
