#include "innermap/field/fit.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <string>

#include "core/require_number.h"
#include "innermap/core/error.h"
#include "innermap/core/memory.h"
#include "innermap/core/run.h"

namespace innermap {
namespace {

constexpr double kNearestSpacings = 0.8;  // spacings
constexpr double kFarthest = 0.5;         // of the diagonal
// A farther shell has larger weights that cancel each other: it must earn its place.
constexpr double kGain = 0.8;
// When a trial can hardly tell the nearest distance from the next, a full fit at some more spacings
// can: the more sources, the smoother the values look.
constexpr double kClose = 1.25, kNextNearest = 1.6;
constexpr std::size_t kTrialSources = 600;
// Trials end here: an error so many times the best, or over it so often in a row.
constexpr double kMuchWorse = 1.5;
constexpr int kMostWorse = 2;
constexpr std::size_t kTrialPointsPerSource = 4;
constexpr std::size_t kMostDense = 20000;
// The iterative solver's shells: distances in spacings of their own sources.
constexpr double kIterativeDistance = 0.9, kCoarseDistance = 1.25;
constexpr double kIterativeGuard = 4;  // spacings; clusters see no farther

constexpr double kSmoothGain = 0.25;  // of the error at held-out vertices
constexpr std::size_t kFewestVertices = 100;

struct Solved {
  Points sources;
  DenseSolution solution;
  double distance = 0;
};

// The best of the distances tried with few sources, and the nearest of them.
struct Trial {
  std::optional<Solved> best;
  double nearest = 0;
  bool close = false;  // the second distance is about as good as the nearest
};

bool useIterative(std::size_t sources, FitSolver solver) {
  return solver == FitSolver::iterative ||
         (solver == FitSolver::automatic && sources > kMostDenseSources);
}

// Sources of the coarse shell for so many fine ones.
std::size_t coarseCount(std::size_t sources) {
  return std::clamp<std::size_t>(sources / 8, std::min<std::size_t>(sources, 300), 2500);
}

class Fitting {
 public:
  Fitting(const FitProblem& problem, const FitSettings& settings)
      : problem_(problem), settings_(settings) {}

  FitResult run() {
    check();
    const bool smooth = chooseSmooth();
    return !smooth && solver() == FitSolver::iterative ? iterative() : dense(smooth);
  }

  std::optional<FitResult> runSmooth() {
    check();
    if (!chooseSmooth()) return {};
    return dense(true);
  }

 private:
  FitResult dense(bool smooth) {
    const BoundaryData& data = smooth ? problem_.vertices : problem_.surface;
    const std::size_t count = sourcesFor(data, settings_.sources);
    std::optional<Solved> best;
    const std::vector<double> distances = distancesFor(smooth, count);
    for (const double distance : distances) {
      Solved solved = solve(data, count, data.points.size(), distance);
      if (distances.size() > 1) remember(solved, smooth);
      if (!best || solved.solution.heldOutRms < kGain * best->solution.heldOutRms)
        best = std::move(solved);
    }
    const DenseSolution& solution = best->solution;
    HarmonicField field(std::move(best->sources), solution.weights, solution.affine);
    return {std::move(field),
            false,
            best->distance,
            smooth,
            std::move(trials_),
            solution.weightNorm,
            solution.regularization,
            solution.condition,
            solution.rank,
            {},
            0};
  }

  FitResult iterative();
  void check() const;
  bool chooseSmooth();
  const Trial& trial(bool smooth);
  Trial makeTrial(bool smooth);
  std::vector<double> distancesFor(bool smooth, std::size_t count);
  Solved solve(const BoundaryData& data, std::size_t count, std::size_t points, double distance);

  SourceLevel level(std::size_t count, double distance) const {
    return {problem_.placeSources(count, distance), spacing(count), distance * problem_.diagonal};
  }

  // The trials of linear and of smooth values stand on the same ones.
  const Points& shell(std::size_t count, double distance) {
    const auto known = shells_.find({count, distance});
    if (known != shells_.end()) return known->second;
    return shells_[{count, distance}] = problem_.placeSources(count, distance);
  }

  double spacing(std::size_t count) const {
    return std::sqrt(problem_.area / static_cast<double>(count));
  }

  // Dense or iterative; the latter cannot take charges that are given far away.
  FitSolver solver() const {
    const bool far = settings_.distance && *settings_.distance * problem_.diagonal >
                                               kIterativeGuard * spacing(settings_.sources);
    const bool many = useIterative(settings_.sources, settings_.solver);
    return many && !(far && settings_.solver == FitSolver::automatic) ? FitSolver::iterative
                                                                      : FitSolver::dense;
  }

  // At least two points a source: vertices may be few. Smooth values need no more sources than the
  // dense solver takes.
  std::size_t sourcesFor(const BoundaryData& data, std::size_t wanted) const {
    if (&data != &problem_.vertices) return wanted;
    const std::size_t most = settings_.solver == FitSolver::dense ? kMostDense : kMostDenseSources;
    return std::min({wanted, most, data.points.size() / 2});
  }

  double nearest(std::size_t count) const {
    return kNearestSpacings * spacing(count) / problem_.diagonal;
  }

  void remember(const Solved& s, bool smooth) {
    trials_.push_back({s.sources.size(), s.distance, smooth, s.solution.heldOutRms});
  }

  const FitProblem& problem_;
  const FitSettings& settings_;
  std::optional<Trial> trialOf_[2];
  std::map<std::pair<std::size_t, double>, Points> shells_;
  std::vector<DistanceTrial> trials_;
};

void checkShape(const BoundaryData& data) {
  if (data.values.rows() != data.points.size() || data.heldOutValues.rows() != data.heldOut.size())
    throw DataError("fit: the values do not fit the points");
}

void Fitting::check() const {
  const bool iterates = solver() == FitSolver::iterative;
  if (settings_.sources < 1 || settings_.sources > (iterates ? kMaxCharges : kMostDense))
    throw SettingError("charges", iterates ? "must lie in 1 to 1000000"
                                           : "must lie in 1 to 20000 for the dense solver");
  if (settings_.distance)
    requireNumber("distance", *settings_.distance, {1e-4, 2}, "of the diagonal");
  if (!(problem_.diagonal > 0) || !(problem_.area > 0))
    throw DataError("fit: the boundary has no extent");
  checkShape(problem_.surface);
  checkShape(problem_.vertices);
  if (problem_.surface.heldOut.empty() && !(settings_.distance && settings_.regularization))
    throw SettingError("held-out points", "are needed to choose distance and regularisation by");
  if (settings_.interpolation == Interpolation::smooth &&
      problem_.vertices.points.size() < kFewestVertices)
    throw SettingError("interpolation", "smooth needs at least " + std::to_string(kFewestVertices) +
                                            " vertices on the boundary; choose linear");
  requireMemory("fitting " + std::to_string(settings_.sources) + " sources",
                fitMemory(problem_.surface.points.size(), settings_.sources,
                          problem_.surface.heldOut.size(), solver()),
                memoryLeft(), "use fewer charges");
}

Solved Fitting::solve(const BoundaryData& data, std::size_t count, std::size_t points,
                      double distance) {
  Solved out;
  out.distance = distance;
  out.sources = shell(count, distance);
  const std::size_t used = std::min(data.points.size(), points);
  std::vector<std::size_t> first(used);
  std::iota(first.begin(), first.end(), 0);
  const Collocation collocation = Collocation(data.points, data.directions).subset(first);
  Matrix values(used, data.values.columns());
  for (std::size_t k = 0; k < values.columns(); ++k)
    std::copy_n(data.values.column(k), used, values.column(k));
  const DenseSolver solver(collocation, out.sources, {data.heldOut, data.heldOutDirections});
  out.solution =
      solver.solve(values, settings_.method, data.heldOutValues, settings_.regularization);
  return out;
}

Trial Fitting::makeTrial(bool smooth) {
  const BoundaryData& data = smooth ? problem_.vertices : problem_.surface;
  const std::size_t few = std::max<std::size_t>(
      1, sourcesFor(data, std::min(settings_.trialSources, settings_.sources / 2)));
  Trial out;
  out.nearest = settings_.distance.value_or(nearest(few));
  const double farthest = settings_.distance.value_or(std::max(kFarthest, out.nearest));
  const int steps = static_cast<int>(std::ceil(std::log2(farthest / out.nearest)));
  int worse = 0;
  for (int step = 0; step <= steps; ++step) {
    const double ratio = steps ? 1.0 * step / steps : 0;
    reportProgress("choosing the distance", ratio);
    if (out.best && outOfTime()) break;
    try {
      Solved solved = solve(data, few, kTrialPointsPerSource * few + 16,
                            out.nearest * std::pow(farthest / out.nearest, ratio));
      remember(solved, smooth);
      const double rms = solved.solution.heldOutRms;
      if (step == 1 && out.best) out.close = rms < kClose * out.best->solution.heldOutRms;
      worse = out.best && rms > out.best->solution.heldOutRms ? worse + 1 : 0;
      if (!out.best || rms < kGain * out.best->solution.heldOutRms)
        out.best = std::move(solved);
      else if (worse == kMostWorse || rms > kMuchWorse * out.best->solution.heldOutRms)
        break;
    } catch (const DataError&) {
      continue;  // no room at this distance
    }
  }
  return out;
}

const Trial& Fitting::trial(bool smooth) {
  if (!trialOf_[smooth]) trialOf_[smooth] = makeTrial(smooth);
  return *trialOf_[smooth];
}

bool Fitting::chooseSmooth() {
  if (settings_.interpolation != Interpolation::automatic)
    return settings_.interpolation == Interpolation::smooth;
  const BoundaryData& vertices = problem_.vertices;
  if (vertices.points.size() < kFewestVertices || vertices.heldOut.empty()) return false;
  const Trial &linear = trial(false), &smooth = trial(true);
  if (!smooth.best) return false;
  if (!linear.best) return true;
  const HarmonicField field(linear.best->sources, linear.best->solution.weights,
                            linear.best->solution.affine);
  const double linearRms =
      measureBoundaryError(field, vertices.heldOut, vertices.heldOutValues, 1, {0}).rms;
  return smooth.best->solution.heldOutRms < kSmoothGain * linearRms;
}

FitResult Fitting::iterative() {
  const std::size_t fine = settings_.sources, coarse = coarseCount(fine);
  const double distance =
      settings_.distance.value_or(kIterativeDistance * spacing(fine) / problem_.diagonal);
  if (distance * problem_.diagonal > kIterativeGuard * spacing(fine))
    throw SettingError("distance",
                       "is over 4 spacings of the sources, which the iterative solver cannot take; "
                       "use a smaller one or the dense solver");
  double far = kCoarseDistance * spacing(coarse) / problem_.diagonal;
  if (settings_.distance) far = std::max(distance, far);
  const SourceLevel levels[2] = {level(coarse, far), level(fine, distance)};
  IterativeSettings s;
  const IterativeSolver solver({problem_.surface.points, problem_.surface.directions},
                               {levels[0], levels[1]}, s);
  IterativeSolution solution = solver.solve(problem_.surface.values);
  Points sources = solver.sources();
  const std::size_t rank = sources.size();
  return {
      HarmonicField(std::move(sources), std::move(solution.weights), std::move(solution.affine)),
      true,
      distance,
      false,
      std::move(trials_),
      solution.weightNorm,
      0,
      0,
      rank,
      std::move(solution.residuals),
      solution.productError};
}

// The one or two distances worth a fit with all sources. The best distance in a trial with fewer
// sources stays best as a length when the values are smooth, and in spacings when they are rough;
// where the trial leaves that open, both are returned.
std::vector<double> Fitting::distancesFor(bool smooth, std::size_t count) {
  if (settings_.distance) return {*settings_.distance};
  const Trial& tried = trial(smooth);
  const double atLeast = nearest(count);
  if (!tried.best || tried.best->distance <= tried.nearest) {
    if (!tried.close) return {atLeast};
    return {atLeast, kNextNearest * atLeast};
  }
  const double best = tried.best->distance,
               scaled = std::max(atLeast, best * atLeast / tried.nearest);
  if (scaled > 0.8 * best) return {best};
  return {scaled, best};
}

}  // namespace

std::uint64_t fitMemory(std::size_t collocation, std::size_t sources, std::size_t heldOut,
                        FitSolver solver) {
  if (!useIterative(sources, solver)) return denseSolverMemory(collocation, sources, heldOut);
  // The trials are dense.
  const std::size_t few = std::min(kTrialSources, sources);
  return std::max(iterativeSolverMemory(collocation, sources, coarseCount(sources)),
                  denseSolverMemory(kTrialPointsPerSource * few, few, heldOut));
}

FitResult fitField(const FitProblem& problem, const FitSettings& settings) {
  return Fitting(problem, settings).run();
}

std::optional<FitResult> fitSmooth(const FitProblem& problem, const FitSettings& settings) {
  return Fitting(problem, settings).runSmooth();
}

}  // namespace innermap
