#include "fit/detail/map_fitter.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "fit/detail/boundary_check.h"
#include "fit/detail/pair_problem.h"
#include "fit/detail/solid_proof.h"
#include "fit/detail/step_fit.h"
#include "innermap/core/memory.h"
#include "innermap/core/run.h"

namespace innermap {
namespace {

constexpr std::size_t kTrialSources = 200;  // of a fit to vertices
constexpr std::size_t kInside = 20000, kPlaces = 16;
// What a thousand charges fold is near what the whole fit does, where that is so much: no need to
// go on to it.
constexpr double kHopelessFolds = 2 * kManyFolds;
// Of one map's folds may be left by steps, times as often as their error exceeds the tolerance.
constexpr double kWorthIt = 0.5;
// Steps of a map beyond which a proof that nobody asked for in particular looks at fewer cells, by
// the square: each takes time in proportion to the steps, and less of them is proven.
constexpr double kManySteps = 8;
constexpr double kInsideSumAccuracy = 1e-7;  // of the target's diagonal, of what is checked inside

// A fit with a number of charges.
FitOutcome outcomeOf(const FitResult& fit, const FitProblem& problem, const ShellSettings& shell) {
  const BoundaryData& data = fit.smooth ? problem.vertices : problem.surface;
  FitOutcome out{HarmonicMap(fit.field), {}, {}, 0, fit.smooth, {}, {}, {}, {}, {}, {}};
  MapSolve& s = out.solve;
  s.method = fit.iterative                                  ? SolveMethod::iterative
             : shell.method == Regularization::truncatedSvd ? SolveMethod::truncatedSvd
                                                            : SolveMethod::tikhonov;
  s.placement = shell.radiusRatio ? MapPlacement::sphere : MapPlacement::shell;
  s.sources = fit.field.sources().size();
  s.collocation = data.points.size();
  s.heldOut = data.heldOut.size();
  s.rank = fit.rank;
  if (shell.radiusRatio)
    s.radiusRatio = *shell.radiusRatio;
  else
    s.distance = fit.distance;
  s.regularization = fit.regularization;
  s.condition = fit.condition;
  s.weightNorm = fit.weightNorm;
  s.productError = fit.productError;
  s.iterations = fit.iterative ? static_cast<int>(fit.residuals.size()) - 1 : 0;
  s.residuals = fit.residuals;
  s.trials = fit.trials;
  return out;
}

// A fit to a tolerance.
FitOutcome outcomeOf(const AdaptiveResult& fit, double unit) {
  FitOutcome out{HarmonicMap(fit.field), fit.error, {}, 0, false, {}, {}, {}, {}, {}, {}};
  out.collocationError =
      std::pow(fit.residuals.back() / unit, 2) * static_cast<double>(fit.collocation);
  MapSolve& s = out.solve;
  s.sources = s.rank = fit.field.sources().size();
  s.collocation = fit.collocation;
  s.distance = fit.levels.front().distance;
  s.weightNorm = fit.weightNorm;
  s.productError = fit.productError;
  s.iterations = static_cast<int>(fit.residuals.size()) - 1;
  s.residuals = fit.residuals;
  s.levels = fit.levels;
  s.rounds = fit.rounds;
  return out;
}

FitSettings fitSettings(const ShellSettings& shell, const FitMapSettings& settings) {
  FitSettings fit;
  fit.sources = shell.sources;
  fit.solver = shell.solver;
  fit.interpolation = settings.interpolation;
  fit.distance = shell.distance;
  if (shell.radiusRatio) {
    fit.distance = 1.0;             // plays no part: one fit, nothing to choose
    fit.solver = FitSolver::dense;  // the sphere is far from most of the surface
  }
  fit.method = shell.method;
  fit.regularization = shell.regularization;
  return fit;
}

}  // namespace

PointCounts pointCounts(const ShellSettings& shell) {
  PointCounts counts;
  counts.sources = shell.sources;
  counts.collocation = shellCollocation(shell);
  counts.heldOut = std::clamp<std::size_t>(counts.sources, 1000, 5000);
  return counts;
}

MapFitter::MapFitter(const BoundaryPair& pair, const FitMapSettings& settings)
    : pair_(pair), settings_(settings), orientation_(orientationOf(pair.solid(), pair.target)) {}

FitOutcome MapFitter::onShell(const ShellSettings& shell) {
  const FitProblem problem = problemOf(pointCounts(shell));
  const FitResult fit =
      timed(seconds, "fit", [&] { return fitField(problem, fitSettings(shell, settings_)); });
  FitOutcome out = outcomeOf(fit, problem, shell);
  certify(out);
  measure(problem, out);
  return out;
}

FitOutcome MapFitter::within(double tolerance, bool mayStop) {
  std::optional<FitOutcome> out = tryVertices(tolerance);
  AdaptiveEnd end = AdaptiveEnd::met;
  if (!out) {
    AdaptiveSettings settings = adaptiveSettings(tolerance);
    if (mayStop && mayTakeSteps())
      settings.goOn = [this](const HarmonicField& field, int round) {
        return round > 1 || foldedShare(insideOf(HarmonicMap(field)).determinants, orientation_) <=
                                kHopelessFolds;
      };
    timed(seconds, "fit", [&] {
      const AdaptiveResult fit = fitToTolerance(problem(tolerance), settings);
      end = fit.end;
      out.emplace(outcomeOf(fit, pair_.target.diagonal));
    });
    if (end != AdaptiveEnd::stopped) certify(*out);
  }
  out->tolerance = ToleranceOutcome{tolerance, out->error.p99, out->error.p99 <= tolerance, end};
  return std::move(*out);
}

void MapFitter::check(FitOutcome& out) {
  timed(seconds, "inside", [&] {
    target_.emplace(pair_);
    out.inside = figuresOf(out);
  });
  if (!mayTakeSteps()) return;
  if (settings_.oneToOne == OneToOne::on && out.inside.folded == 0) prove(out);
  if (!foldsTooMuch(out)) return;
  singleFolded = out.inside.folded;
  singleSources = out.solve.sources;
  if (!roomForSteps() || outOfTime()) return finishSingle(out);
  FitOutcome steps = inSteps();
  if (areBetter(steps, out))
    out = std::move(steps);
  else
    finishSingle(out);
}

bool MapFitter::foldsTooMuch(const FitOutcome& out) const {
  const bool on = settings_.oneToOne == OneToOne::on;
  return out.inside.folded > (on ? 0 : kManyFolds) || out.inside.outside > kManyOutside ||
         (on && out.proof && out.proof->negative > 0);
}

bool MapFitter::areBetter(FitOutcome& steps, const FitOutcome& single) {
  if (settings_.oneToOne != OneToOne::on)
    return steps.inside.folded * std::max(1.0, steps.error.p99 / settings_.tolerance) <=
           kWorthIt * single.inside.folded;
  if (!single.proof || single.proof->negative == 0 || steps.inside.folded > 0)
    return steps.inside.folded <= single.inside.folded;
  prove(steps);
  return steps.proof && steps.proof->negativeShare < single.proof->negativeShare;
}

Injectivity MapFitter::injectivityOf(FitOutcome& out) {
  Injectivity known = innermap::injectivityOf(pair_);
  timed(seconds, "inside", [&] {
    known.inside = out.inside.determinants;
    known.outside = out.inside.outside;
    checkBoundary(out.map, pair_, *target_, out.error.p99, settings_.seed, known);
  });
  prove(out);
  if (out.proof) known.proof = *out.proof;
  return known;
}

void MapFitter::prove(FitOutcome& out) {
  if (settings_.prove == Prove::off || out.proof) return;
  const bool on = settings_.oneToOne == OneToOne::on;
  const double share = std::min(1.0, kManySteps / static_cast<double>(out.map.steps().size()));
  const double cells = on ? std::max(settings_.proofCells, ProofSettings().cellsPerCharge)
                          : std::max(1.0, share * share * settings_.proofCells);
  timed(seconds, "proof",
        [&] { out.proof = tryProof(out.map, pair_, settings_.prove, cells, warnings); });
}

// Onto a target that is turned inside out somewhere no map is one-to-one.
bool MapFitter::mayTakeSteps() const {
  return settings_.oneToOne != OneToOne::off && !settings_.shell && pair_.target.volume > 0;
}

const Points& MapFitter::inside() {
  if (inside_.empty()) inside_ = pointsInside(pair_.solid(), kInside);
  return inside_;
}

MappedPoints MapFitter::insideOf(const ComposedMap& map) {
  return mapPoints(map, inside(), kInsideSumAccuracy * pair_.target.diagonal);
}

bool MapFitter::roomForSteps() {
  const std::uint64_t need = processMemory(kStepsMemory);
  if (need <= memoryLimit()) return true;
  warnings.push_back(
      fmt::format("one harmonic map folds {:.2g}% of the inside; steps may need about {}, more "
                  "than the limit of {}, so innermap takes none",
                  100 * singleFolded, formatBytes(need), formatBytes(memoryLimit())));
  return false;
}

// Where the fit ended with its first charges, for steps that are not taken.
void MapFitter::finishSingle(FitOutcome& out) {
  if (out.tolerance->end != AdaptiveEnd::stopped) return;
  out = within(settings_.tolerance, false);
  timed(seconds, "inside", [&] { out.inside = figuresOf(out); });
}

AdaptiveProblem MapFitter::problem(double tolerance) {
  AdaptiveProblemSettings s;
  s.seed = settings_.seed;
  AdaptiveProblem out = adaptiveProblem(
      pair_.solid(),
      [this](const std::vector<SurfacePoint>& points) { return pair_.targetsOf(points); },
      pair_.target.diagonal, s);
  jumps = CrossingLines(pair_.solid())
              .jumps(pair_.solid(), pair_.target.moved, tolerance * pair_.target.diagonal);
  for (const ValueJump& jump : jumps) out.jumps.push_back(jump.place);
  return out;
}

FitProblem MapFitter::problemOf(const PointCounts& counts) {
  PairProblemSettings s;
  s.counts = counts;
  s.vertices = settings_.interpolation != Interpolation::linear;
  if (settings_.shell) s.radiusRatio = settings_.shell->radiusRatio;
  s.seed = settings_.seed;
  return timed(seconds, "sample", [&] { return pairProblem(pair_, s); });
}

AdaptiveSettings MapFitter::adaptiveSettings(double tolerance) const {
  AdaptiveSettings s;
  s.tolerance = tolerance;
  s.maxSources = settings_.maxSources;
  s.checkSamples = kFreshSamples;
  return s;
}

InsideFigures MapFitter::figuresOf(const FitOutcome& out) {
  const double slack = out.error.p99 * pair_.target.diagonal;
  const MappedPoints here = insideOf(out.map);
  InsideFigures figures;
  figures.samples = inside_.size();
  figures.folded = foldedShare(here.determinants, orientation_);
  figures.determinants = determinantsOf(here, *target_, slack);
  for (std::size_t i = 0; i < inside_.size() && figures.foldedAt.size() < kPlaces; ++i)
    if (!(orientation_ * here.determinants[i] > 0)) figures.foldedAt.push_back(inside_[i]);
  figures.outside = outsideShare(here.points, *target_, slack);
  return figures;
}

FitOutcome MapFitter::inSteps() {
  StepFitSettings s;
  s.tolerance = settings_.tolerance;
  s.folds = settings_.oneToOne == OneToOne::on ? 0 : kFewFolds;
  if (settings_.oneToOne == OneToOne::on && settings_.prove != Prove::off)
    s.proofCells = settings_.proofCells;
  s.maxSteps = settings_.maxSteps;
  s.maxSources = settings_.maxSources;
  s.seed = settings_.seed;
  StepFit fit = timed(seconds, "steps", [&] { return fitInSteps(pair_, inside(), s); });
  FitOutcome out{std::move(fit.map),   fit.error, {}, 0, false, {}, {}, {}, {},
                 std::move(fit.steps), {}};
  out.solve.method = SolveMethod::steps;
  out.solve.placement = MapPlacement::steps;
  out.solve.sources = out.solve.rank = out.map.sources();
  certify(out);
  timed(seconds, "inside", [&] { out.inside = figuresOf(out); });
  out.tolerance =
      ToleranceOutcome{settings_.tolerance, out.error.p99, out.error.p99 <= settings_.tolerance,
                       fit.end == AdaptiveEnd::met ? AdaptiveEnd::noGain : fit.end};
  return out;
}

// Where vertices sample a smooth deformation, a fit to them is far more exact, and quick.
std::optional<FitOutcome> MapFitter::tryVertices(double tolerance) {
  if (settings_.interpolation == Interpolation::linear) return {};
  const FitProblem problem = problemOf(kFirstCounts);
  ShellSettings shell;
  shell.sources = kFirstCounts.sources;
  FitSettings fitting = fitSettings(shell, settings_);
  fitting.trialSources = kTrialSources;
  const std::optional<FitResult> fit =
      timed(seconds, "fit", [&] { return fitSmooth(problem, fitting); });
  if (!fit) return {};
  FitOutcome out = outcomeOf(*fit, problem, shell);
  certify(out);
  if (out.error.p99 > tolerance && settings_.interpolation == Interpolation::automatic) return {};
  measure(problem, out);
  return out;
}

// With a number of charges, after certify(): at the points of the fit.
void MapFitter::measure(const FitProblem& problem, FitOutcome& out) {
  timed(seconds, "certificate", [&] {
    BoundaryErrorSettings e;
    e.accuracy = out.certificate.accuracy;
    const auto error = [&](const Points& points, const Matrix& values) {
      return measureBoundaryError(out.map.steps().front().field(), points, values,
                                  pair_.target.diagonal, e);
    };
    const BoundaryData& data = out.smooth ? problem.vertices : problem.surface;
    out.collocationError = error(data.points, data.values).sumOfSquares;
    if (out.smooth) out.verticesRms = error(data.heldOut, data.heldOutValues).rms;
  });
}

// What an adaptive fit measured by plain sums stays.
void MapFitter::certify(FitOutcome& out) {
  MapCertificateSettings s;
  s.smooth = out.smooth;
  s.tolerance = settings_.tolerance;
  s.seed = settings_.seed;
  out.certificate = timed(seconds, "certificate", [&] { return certifyMap(out.map, pair_, s); });
  BoundaryError error = out.certificate.error;
  if (out.error.samples > 0) {
    error.rms = out.error.rms;
    error.p99 = out.error.p99;
    error.sumOfSquares = out.error.sumOfSquares;
  }
  out.error = error;
}

}  // namespace innermap
