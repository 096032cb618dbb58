#include "innermap/study/study.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "core/memory_limit.h"
#include "innermap/core/error.h"
#include "innermap/core/run.h"
#include "mesh/shapes.h"

namespace innermap {
namespace {

BoundaryPair pairOf(double bend = 0.3) {
  const Mesh source = shapes::icosphere(3);
  Mesh target = source;
  for (Vec3& p : target.vertices) p = {p.x + bend * p.y * p.y, 1.2 * p.y, p.z + 0.2 * p.x};
  return makeBoundaryPair(source, target);
}

StudySettings quick() {
  StudySettings s;
  s.sources = {50, 100};
  s.collocation = {1, 3};
  s.distances = {0.05, 0.2};
  s.radiusRatios = {1.5};
  s.baseSources = 100;
  s.baseCollocation = 3;
  s.baseDistance = 0.2;
  s.resolution = 16;
  s.grid = StudyGrid::none;
  return s;
}

struct Folder {
  std::filesystem::path path = std::filesystem::path(testing::TempDir()) /
                               testing::UnitTest::GetInstance()->current_test_info()->name();
  Folder() { std::filesystem::remove_all(path); }
  ~Folder() { std::filesystem::remove_all(path); }
};

std::size_t filesIn(const std::filesystem::path& folder) {
  std::size_t n = 0;
  for ([[maybe_unused]] const auto& file : std::filesystem::directory_iterator(folder)) ++n;
  return n;
}

TEST(Study, RunsAreEachListAndTheGrid) {
  const BoundaryPair pair = pairOf();
  StudySettings s = quick();
  // The base, another distance, another number, another ratio; on spheres the base and a number.
  EXPECT_EQ(studyRuns(pair.solid(), s).size(), 6u);
  s.grid = StudyGrid::pairs;
  const std::vector<StudyRun> pairs = studyRuns(pair.solid(), s);
  // Beside: (50, near), (near, 1 point), (50, 1 point); on spheres (100, 1), (50, 1).
  EXPECT_EQ(pairs.size(), 11u);
  s.grid = StudyGrid::full;
  EXPECT_EQ(studyRuns(pair.solid(), s).size(), 8u + 4u);
  for (std::size_t i = 0; i < pairs.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) EXPECT_FALSE(sameRun(pairs[i], pairs[j]));
  s.radiusRatios.clear();
  for (const StudyRun& run : studyRuns(pair.solid(), s))
    EXPECT_EQ(run.placement, ChargePlacement::offset);
}

TEST(Study, BaseDistanceIsTheSpacing) {
  const BoundaryPair pair = pairOf();
  StudySettings s = quick();
  s.baseDistance.reset();
  const double area = pair.solid().area(), diagonal = pair.solid().diagonal();
  EXPECT_NEAR(studyRuns(pair.solid(), s).front().at * diagonal, std::sqrt(area / 100),
              0.05 * std::sqrt(area / 100));
}

TEST(Study, RefusesSettings) {
  const BoundaryPair pair = pairOf();
  const auto refused = [&](auto change) {
    StudySettings s = quick();
    change(s);
    EXPECT_THROW(studyRuns(pair.solid(), s), SettingError);
  };
  refused([](StudySettings& s) { s.sources = {100, 50}; });
  refused([](StudySettings& s) { s.sources = {2}; });
  refused([](StudySettings& s) { s.collocation = {0.5}; });
  refused([](StudySettings& s) { s.distances = {3}; });
  refused([](StudySettings& s) { s.distances = {std::nan("")}; });
  refused([](StudySettings& s) { s.radiusRatios = {1}; });
  refused([](StudySettings& s) { s.interpolation = Interpolation::automatic; });
  refused([](StudySettings& s) { s.resolution = 2; });
  refused([](StudySettings& s) { s.regularization = 2; });
  refused([](StudySettings& s) {
    s.grid = StudyGrid::full;
    s.sources.assign(200, 50);
    s.distances.assign(200, 0.1);
  });
}

TEST(Study, FiguresAreThoseOfTheMap) {
  const BoundaryPair pair = pairOf();
  StudySettings s = quick();
  s.distances.clear();
  s.sources.clear();
  s.collocation.clear();
  s.radiusRatios.clear();
  const Study study = runStudy(pair, s);
  ASSERT_EQ(study.rows.size(), 1u);
  const StudyRow& row = study.rows[0];
  FitMapSettings fitting;
  ShellSettings shell;
  shell.sources = 100;
  shell.collocation = 300;
  shell.distance = 0.2;
  shell.solver = FitSolver::dense;
  fitting.shell = shell;
  fitting.interpolation = Interpolation::linear;
  const MapFit fit = fitMap(pair, fitting);
  EXPECT_NEAR(row.rms, fit.error.rms, 1e-12);
  EXPECT_NEAR(row.max, fit.error.max, 1e-12);
  EXPECT_NEAR(row.cError, fit.collocationError, 1e-12);
  EXPECT_NEAR(row.collocationRms, std::sqrt(fit.collocationError / 300), 1e-12);
  EXPECT_NEAR(row.weights, fit.solve.weightNorm, 1e-9 * fit.solve.weightNorm);
  EXPECT_NEAR(row.condition, fit.solve.condition, 1e-9 * fit.solve.condition);
  EXPECT_EQ(row.points, 300u);
  EXPECT_GT(row.harmonicEnergy, 3);
  EXPECT_GT(row.deformationEnergy, 0);
  EXPECT_NEAR(row.folded, 0, 1e-12);
  EXPECT_GT(row.jacobianMin, 0);
  EXPECT_GE(row.secondsOverall, row.seconds);
}

TEST(Study, KeptRunsAreNotMadeAgain) {
  const Folder folder;
  StudySettings s = quick();
  s.folder = folder.path.string();
  const BoundaryPair pair = pairOf();
  const Study first = runStudy(pair, s);
  EXPECT_EQ(first.made, 6u);
  EXPECT_EQ(first.kept, 0u);
  EXPECT_EQ(filesIn(folder.path), 6u);
  s.distances.push_back(0.4);
  const Study second = runStudy(pair, s);
  EXPECT_EQ(second.made, 1u);
  EXPECT_EQ(second.kept, 6u);
  for (const StudyRow& row : first.rows) {
    EXPECT_TRUE(isKept(pair, row, s));
    for (const StudyRow& again : second.rows)
      if (sameRun(row, again)) {
        EXPECT_TRUE(again.kept);
        EXPECT_NEAR(again.rms, row.rms, 0);
        EXPECT_NEAR(again.condition, row.condition, 0);
        EXPECT_NEAR(again.seconds, row.seconds, 0);
        EXPECT_EQ(again.rank, row.rank);
      }
  }
  // Other settings, other boundaries.
  s.seed = 2;
  EXPECT_FALSE(isKept(pair, first.rows[0], s));
  s.seed = 1;
  s.resolution = 20;
  EXPECT_FALSE(isKept(pair, first.rows[0], s));
  s.resolution = 16;
  EXPECT_FALSE(isKept(pairOf(0.31), first.rows[0], s));
  EXPECT_TRUE(isKept(pair, first.rows[0], s));
}

TEST(Study, DamagedFilesAreMadeAgain) {
  const Folder folder;
  StudySettings s = quick();
  s.folder = folder.path.string();
  const BoundaryPair pair = pairOf();
  runStudy(pair, s);
  int i = 0;
  for (const auto& file : std::filesystem::directory_iterator(folder.path)) {
    const auto size = std::filesystem::file_size(file);
    if (i == 0) std::filesystem::resize_file(file, size / 2);
    if (i == 1) std::filesystem::resize_file(file, 0);
    if (i == 2) std::ofstream(file.path()) << "innermap study run 1\nend\n";
    if (i == 3) std::ofstream(file.path()) << std::string(100000, 'x');
    ++i;
  }
  const Study again = runStudy(pair, s);
  EXPECT_EQ(again.made, 4u);
  EXPECT_EQ(again.kept, 2u);
}

struct Stop : std::runtime_error {
  using std::runtime_error::runtime_error;
};

TEST(Study, GoesOnWhereItWasStopped) {
  const Folder folder;
  StudySettings s = quick();
  s.folder = folder.path.string();
  const BoundaryPair pair = pairOf();
  EXPECT_THROW(runStudy(pair, s,
                        [](const StudyRow*, std::size_t done, std::size_t all) {
                          EXPECT_EQ(all, 6u);
                          if (done == 2) throw Stop("");
                        }),
               Stop);
  {
    RunContext cancelled;
    cancelled.cancel();
    const RunScope scope(cancelled);
    EXPECT_THROW(runStudy(pair, s), Cancelled);
  }
  std::vector<std::size_t> told;
  const Study study = runStudy(
      pair, s, [&](const StudyRow*, std::size_t done, std::size_t) { told.push_back(done); });
  EXPECT_EQ(study.kept, 2u);
  EXPECT_EQ(study.made, 4u);
  EXPECT_EQ(told, (std::vector<std::size_t>{0, 1, 2, 3, 4, 5, 6}));
}

TEST(Study, LimitsLeaveRunsOut) {
  const Folder folder;
  StudySettings s = quick();
  s.folder = folder.path.string();
  const BoundaryPair pair = pairOf();
  const Study none = [&] {
    RunContext late;
    late.setSecondsLeft(0);
    const RunScope scope(late);
    return runStudy(pair, s);
  }();
  EXPECT_EQ(none.left, 6u);
  EXPECT_TRUE(none.rows.empty());
  const Study small = [&] {
    const MemoryLimit limit(1000);
    return runStudy(pair, s);
  }();
  ASSERT_EQ(small.rows.size(), 6u);
  for (const StudyRow& row : small.rows) EXPECT_NE(row.failure.find("limit"), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(folder.path));  // with more memory they may be made
  EXPECT_GT(studyMemory({4000, 4, ChargePlacement::offset, 0.1}),
            studyMemory({1000, 4, ChargePlacement::offset, 0.1}));
}

}  // namespace
}  // namespace innermap
