#include "innermap/study/study.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "innermap/core/error.h"
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

}  // namespace
}  // namespace innermap
