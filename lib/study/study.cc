#include "innermap/study/study.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "core/require_number.h"
#include "innermap/core/error.h"
#include "innermap/core/memory.h"
#include "innermap/core/run.h"
#include "innermap/evaluate/evaluate_map.h"
#include "innermap/levelset/level_set.h"
#include "study/detail/kept_runs.h"

namespace innermap {
namespace {

constexpr std::size_t kFewestSources = 16, kMostSources = 20000;

// Of a run beside the solver: the certificate, the voxels;
// measured.
constexpr std::uint64_t kOther = 30'000'000;
constexpr std::size_t kFewestHeldOut = 1000, kMostHeldOut = 5000;  // of fitMap

using Clock = std::chrono::steady_clock;

double secondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

double spacingOfOne(const Solid& source) { return std::sqrt(source.area()) / source.diagonal(); }

// To two digits.
double roundedOff(double v) {
  const double unit = std::pow(10, std::floor(std::log10(v)) - 1);
  return std::round(v / unit) * unit;
}

StudyRun baseRun(const Solid& source, const StudySettings& settings) {
  StudyRun base;
  base.sources = settings.baseSources;
  base.collocation = settings.baseCollocation;
  const double spacing = spacingOfOne(source) / std::sqrt(static_cast<double>(base.sources));
  base.at = settings.baseDistance.value_or(std::clamp(roundedOff(spacing), 1e-4, 2.0));
  return base;
}

StudyRun sphereRun(const StudyRun& base, const StudySettings& settings) {
  StudyRun sphere = base;
  sphere.placement = ChargePlacement::sphere;
  sphere.at = settings.baseRadiusRatio;
  return sphere;
}

void checkRun(const StudyRun& run) {
  if (run.sources < kFewestSources || run.sources > kMostSources)
    throw SettingError("charges",
                       fmt::format("must lie between {} and {}", kFewestSources, kMostSources));
  requireNumber("collocation", run.collocation, {1, 100}, "points a charge");
  if (run.placement == ChargePlacement::offset) {
    requireNumber("distances", run.at, {1e-4, 2}, "of the diagonal");
  } else {
    requireNumber("radius ratios", run.at, {1, 100, true});
  }
}

void checkSettings(const StudySettings& settings) {
  if (settings.interpolation == Interpolation::automatic)
    throw SettingError("interpolation", "must be linear or smooth, the same for all runs");
  requireDescribed(settings);
  const auto ascend = [](const auto& list, const char* name) {
    if (!std::is_sorted(list.begin(), list.end())) throw SettingError(name, "must ascend");
  };
  ascend(settings.sources, "charges");
  ascend(settings.collocation, "collocation");
  ascend(settings.distances, "distances");
  ascend(settings.radiusRatios, "radius ratios");
}

// The base itself where a list is empty.
template <class T>
std::vector<T> orBase(const std::vector<T>& list, T base) {
  return list.empty() ? std::vector<T>{base} : list;
}

class RunList {
 public:
  explicit RunList(const StudySettings& settings) : settings_(settings) {}

  void add(const StudyRun& run) {
    checkRun(run);
    for (const StudyRun& other : runs)
      if (sameRun(run, other)) return;
    runs.push_back(run);
  }

  // The product of the lists that are varied, about the base.
  void product(const StudyRun& base, bool sources, bool collocation, bool place) {
    const auto& places =
        base.placement == ChargePlacement::sphere ? settings_.radiusRatios : settings_.distances;
    const auto counts =
        sources ? orBase(settings_.sources, base.sources) : std::vector{base.sources};
    const auto ratios = collocation ? orBase(settings_.collocation, base.collocation)
                                    : std::vector{base.collocation};
    const auto at = place ? orBase(places, base.at) : std::vector{base.at};
    if (counts.size() > kMostRuns || ratios.size() > kMostRuns || at.size() > kMostRuns ||
        counts.size() * ratios.size() > kMostRuns ||
        counts.size() * ratios.size() * at.size() > kMostRuns)
      throw SettingError("lists", "make more than 10000 runs; shorten them");
    for (const double a : at)
      for (const double ratio : ratios)
        for (const std::size_t count : counts) add({count, ratio, base.placement, a});
  }

  std::vector<StudyRun> runs;

 private:
  const StudySettings& settings_;
};

FitMapSettings fitSettings(const StudyRun& run, const StudySettings& settings) {
  ShellSettings shell;
  shell.sources = run.sources;
  shell.collocation = collocationOf(run);
  (run.placement == ChargePlacement::sphere ? shell.radiusRatio : shell.distance) = run.at;
  shell.solver = FitSolver::dense;
  shell.method = settings.method;
  shell.regularization = settings.regularization;
  FitMapSettings fit;
  fit.shell = shell;
  fit.interpolation = settings.interpolation;
  fit.oneToOne = OneToOne::off;
  fit.seed = settings.seed;
  return fit;
}

void takeFit(const MapFit& fit, StudyRow& row) {
  row.points = fit.solve.collocation;
  row.cError = fit.collocationError;
  row.collocationRms = std::sqrt(row.cError / static_cast<double>(row.points));
  row.rms = fit.error.rms;
  row.p99 = fit.error.p99;
  row.max = fit.error.max;
  row.weights = fit.solve.weightNorm;
  row.condition = fit.solve.condition;
  row.regularization = fit.solve.regularization;
  row.rank = fit.solve.rank;
  row.seconds = 0;
  for (const auto& [stage, seconds] : fit.seconds)
    if (stage == "sample" || stage == "fit") row.seconds += seconds;
}

// Makes runs; the voxels are made with the first.
class Runner {
 public:
  Runner(const BoundaryPair& pair, const StudySettings& settings)
      : pair_(pair), settings_(settings) {}

  StudyRow make(const StudyRun& run) {
    const auto start = Clock::now();
    StudyRow row;
    static_cast<StudyRun&>(row) = run;
    row.points = collocationOf(run);
    if (!levelSet_) voxelize();
    try {
      const MapFit fit = fitMap(pair_, fitSettings(run, settings_));
      takeFit(fit, row);
      takeGrids(fit, row);
    } catch (const DataError& error) {
      row.failure = error.what();
    }
    row.secondsOverall = secondsSince(start);
    return row;
  }

 private:
  void voxelize() {
    LevelSetSettings grid;
    grid.resolution = settings_.resolution;
    levelSet_ = makeLevelSet(pair_.solid(), grid);
    requireInterior(interiorVoxels(*levelSet_), pair_.solid(), pair_.source.mesh.name);
  }

  void takeGrids(const MapFit& fit, StudyRow& row) const {
    EvaluateSettings evaluate;
    evaluate.map = false;
    evaluate.lame = settings_.lame;
    evaluate.targetVolume = pair_.target.volume;
    evaluate.accuracy = sumAccuracy(fit);
    const MapGrids grids = evaluateMap(fit.map, fit.solid(), *levelSet_, evaluate);
    row.harmonicEnergy = grids.harmonicTotal;
    if (grids.volume > 0) row.deformationEnergy = grids.deformationTotal / grids.volume;
    row.jacobianMin = grids.jacobianMin;
    row.folded = grids.foldedFraction;
  }

  const BoundaryPair& pair_;
  const StudySettings& settings_;
  openvdb::FloatGrid::Ptr levelSet_;
};

StudyRow tooLarge(const StudyRun& run, std::uint64_t need) {
  StudyRow row;
  static_cast<StudyRun&>(row) = run;
  row.points = collocationOf(run);
  row.failure = fmt::format("needs about {}, more than the limit of {}", formatBytes(need),
                            formatBytes(memoryLimit()));
  return row;
}

}  // namespace

std::vector<StudyRun> studyRuns(const Solid& source, const StudySettings& settings) {
  checkSettings(settings);
  const StudyRun base = baseRun(source, settings), sphere = sphereRun(base, settings);
  RunList list(settings);
  const bool spheres = !settings.radiusRatios.empty();
  list.add(base);
  list.product(base, false, false, true);
  list.product(base, true, false, false);
  list.product(base, false, true, false);
  if (spheres) {
    list.product(sphere, false, false, true);
    list.product(sphere, true, false, false);
  }
  if (settings.grid == StudyGrid::none) return list.runs;
  const bool full = settings.grid == StudyGrid::full;
  list.product(base, true, full, true);
  list.product(base, false, true, true);
  list.product(base, true, true, full);
  if (spheres) {
    list.product(sphere, true, full, true);
    list.product(sphere, false, true, true);
    list.product(sphere, true, true, full);
  }
  return list.runs;
}

std::uint64_t studyMemory(const StudyRun& run) {
  return kOther + denseSolverMemory(collocationOf(run), run.sources,
                                    std::clamp(run.sources, kFewestHeldOut, kMostHeldOut));
}

bool isKept(const BoundaryPair& pair, const StudyRun& run, const StudySettings& settings) {
  return KeptRuns(pair, settings).find(run).has_value();
}

Study runStudy(const BoundaryPair& pair, const StudySettings& settings,
               const StudyVisitor& visitor) {
  const std::vector<StudyRun> runs = studyRuns(pair.solid(), settings);
  Study study;
  study.base = baseRun(pair.solid(), settings);
  study.baseSphere = sphereRun(study.base, settings);
  study.vertices = pair.source.mesh.vertices.size();
  study.spacing = spacingOfOne(pair.solid());
  const KeptRuns keptRuns(pair, settings);
  Runner runner(pair, settings);
  const std::uint64_t most = memoryLeft();
  if (visitor) visitor(nullptr, 0, runs.size());
  if (settings.share < 1 || settings.share > settings.shares)
    throw SettingError("share", "must be 1 to the number of shares");
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const StudyRun& run = runs[i];
    throwIfCancelled();
    std::optional<StudyRow> row = keptRuns.find(run);
    const std::uint64_t need = studyMemory(run);
    if (row) {
      ++study.kept;
    } else if (i % settings.shares != settings.share - 1 || (need <= most && outOfTime())) {
      ++study.left;
      continue;
    } else if (need > most) {
      row = tooLarge(run, need);
    } else {
      row = runner.make(run);
      keptRuns.keep(*row);
      ++study.made;
    }
    study.rows.push_back(std::move(*row));
    if (visitor) visitor(&study.rows.back(), study.rows.size() + study.left, runs.size());
  }
  return study;
}

std::vector<Setting> describe(StudySettings& s) {
  std::vector<Setting> out{
      Setting("base_charges", "N", &s.baseSources, "charges while others are varied")
          .was("base_sources")
          .from(kFewestSources, kMostSources),
      Setting("base_points", "N", &s.baseCollocation,
              "boundary points a charge while others are varied")
          .from(1, 100),
      Setting("base_distance", "D", &s.baseDistance, "distance while others are varied")
          .in("fraction of the source's diagonal")
          .from(1e-4, 2)
          .otherwise("the spacing of {base_charges} charges"),
      Setting("base_radius_ratio", "R", &s.baseRadiusRatio,
              "radius of the sphere while others are varied, in half diagonals")
          .above(1, 100),
      Setting("grid", "WHICH",
              choiceOf<StudyGrid>(&s.grid, {{"none", StudyGrid::none},
                                            {"pairs", StudyGrid::pairs},
                                            {"full", StudyGrid::full}}),
              "beside each list alone: nothing, each two together, all together"),
      Setting("interpolation", "HOW",
              choiceOf<Interpolation>(&s.interpolation, {{"linear", Interpolation::linear},
                                                         {"smooth", Interpolation::smooth}}),
              "the target between its vertices: flat triangles, or a smooth deformation"),
      Setting("method", "HOW", regularizationChoice(&s.method),
              "of regularisation; the paper's is tsvd"),
      Setting("regularization", "R", &s.regularization, "relative to the largest singular value")
          .from(0, 1)
          .otherwise("chosen for each run by the error at held-out points"),
      Setting("resolution", "N", &s.resolution,
              "voxels along the longest side, for energies and folds")
          .from(4, 1024),
      seedSetting(&s.seed)};
  for (Setting& setting : describe(s.lame)) out.push_back(std::move(setting));
  return out;
}

}  // namespace innermap
