#include "innermap/field/fit.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "innermap/core/error.h"
#include "innermap/core/memory.h"

namespace innermap {
namespace {

constexpr double kNearest = 1.25;  // spacings
constexpr double kFarthest = 0.5;  // of the diagonal
// A farther shell has larger weights that cancel each other: it must earn its place.
constexpr double kGain = 0.8;
constexpr std::size_t kTrialSources = 600;
constexpr std::size_t kTrialPointsPerSource = 4;

struct Solved {
  Points sources;
  DenseSolution solution;
};

class Fitting {
 public:
  Fitting(const FitProblem& problem, const FitSettings& settings)
      : problem_(problem), settings_(settings) {}

  FitResult run() {
    check();
    if (settings_.distance)
      return result(*settings_.distance, solve(settings_.sources, *settings_.distance));
    const std::vector<double> distances = chooseDistances();
    std::optional<Solved> best;
    double bestDistance = 0;
    for (const double distance : distances) {
      Solved solved = solve(settings_.sources, distance);
      if (distances.size() > 1)
        trials_.push_back({solved.sources.size(), distance, solved.solution.heldOutRms});
      if (best && solved.solution.heldOutRms >= kGain * best->solution.heldOutRms) continue;
      best = std::move(solved);
      bestDistance = distance;
    }
    return result(bestDistance, std::move(*best));
  }

 private:
  void check() const;
  std::vector<double> chooseDistances();
  Solved solve(std::size_t count, double distance) const;

  double nearest(std::size_t count) const {
    return kNearest * std::sqrt(problem_.area / static_cast<double>(count)) / problem_.diagonal;
  }

  FitResult result(double distance, Solved solved) {
    HarmonicField field(std::move(solved.sources), solved.solution.weights, solved.solution.affine);
    return {std::move(field), std::move(solved.solution), distance, std::move(trials_)};
  }

  const FitProblem& problem_;
  const FitSettings& settings_;
  std::vector<DistanceTrial> trials_;
};

void Fitting::check() const {
  if (settings_.sources < 1 || settings_.sources > 20000)
    throw SettingError("sources", "must lie in 1 to 20000 for the dense solver");
  if (settings_.distance && !(*settings_.distance >= 1e-4 && *settings_.distance <= 2))
    throw SettingError("distance", "must lie in 0.0001 to 2 of the diagonal");
  if (!(problem_.diagonal > 0) || !(problem_.area > 0))
    throw DataError("fit: the boundary has no extent");
  if (problem_.values.rows() != problem_.collocation.size() ||
      problem_.heldOutValues.rows() != problem_.heldOut.size() ||
      problem_.values.columns() != problem_.heldOutValues.columns())
    throw DataError("fit: the values do not fit the points");
  if (problem_.heldOut.empty() && !(settings_.distance && settings_.regularization))
    throw SettingError("held-out points", "are needed to choose distance and regularisation by");
  requireMemory(
      "fitting " + std::to_string(settings_.sources) + " sources",
      denseSolverMemory(problem_.collocation.size(), settings_.sources, problem_.heldOut.size()),
      settings_.maxMemory, "use fewer sources (memory grows with their square)");
}

Solved Fitting::solve(std::size_t count, double distance) const {
  Solved out;
  out.sources = problem_.placeSources(count, distance);
  const std::size_t points =
      count == settings_.sources
          ? problem_.collocation.size()
          : std::min(problem_.collocation.size(), kTrialPointsPerSource * out.sources.size() + 16);
  const Points collocation(problem_.collocation.begin(), problem_.collocation.begin() + points);
  Matrix values(points, problem_.values.columns());
  for (std::size_t k = 0; k < values.columns(); ++k)
    std::copy_n(problem_.values.column(k), points, values.column(k));
  DenseSettings dense;
  dense.progress = settings_.progress;
  const DenseSolver solver(collocation, out.sources, problem_.heldOut, dense);
  out.solution =
      solver.solve(values, settings_.method, problem_.heldOutValues, settings_.regularization);
  return out;
}

// The one or two distances worth a fit with all sources. The best distance in a trial with fewer
// sources stays best as a length when the values are smooth, and in spacings when they are rough;
// where the trial leaves that open, both are returned.
std::vector<double> Fitting::chooseDistances() {
  const std::size_t few = std::max<std::size_t>(1, std::min(kTrialSources, settings_.sources / 2));
  const double start = nearest(few), atLeast = nearest(settings_.sources);
  double best = 0, bestRms = 0;
  const int steps = std::max(0, static_cast<int>(std::ceil(std::log2(kFarthest / start))));
  for (int step = 0; step <= steps; ++step) {
    const double d = step == 0 ? start : start * std::pow(kFarthest / start, 1.0 * step / steps);
    reportProgress(settings_.progress, "choosing the distance", step / (steps + 1.0));
    try {
      const Solved solved = solve(few, d);
      const double rms = solved.solution.heldOutRms;
      trials_.push_back({solved.sources.size(), d, rms});
      if (best == 0 || rms < kGain * bestRms) {
        best = d;
        bestRms = rms;
      } else if (rms > 4 * bestRms) {
        break;
      }
    } catch (const DataError&) {
      continue;  // no room at this distance
    }
  }
  if (best == 0 || best <= start) return {atLeast};
  const double scaled = std::max(atLeast, best * atLeast / start);
  if (scaled > 0.8 * best) return {best};
  return {scaled, best};
}

}  // namespace

FitResult fitField(const FitProblem& problem, const FitSettings& settings) {
  return Fitting(problem, settings).run();
}

}  // namespace innermap
