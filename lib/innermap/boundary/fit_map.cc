#include "innermap/boundary/fit_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "innermap/boundary/detail/boundary_check.h"
#include "innermap/boundary/detail/inside_check.h"
#include "innermap/boundary/detail/map_certificate.h"
#include "innermap/boundary/detail/pair_problem.h"
#include "innermap/boundary/detail/step_fit.h"
#include "innermap/boundary/surface_problem.h"
#include "innermap/core/error.h"
#include "innermap/core/memory.h"
#include "innermap/core/version.h"

namespace innermap {
namespace {

constexpr double kPointsPerSource = 4, kPointsPerManySources = 3;
// A first fit where a tolerance is asked for: enough to tell smooth deformations from others.
constexpr std::size_t kFirstSources = 1000, kTrialSources = 200;
constexpr std::size_t kInside = 20000, kPlaces = 16;
// Single points beside the surface fold where charges are near them; smaller steps do not cure
// that.
constexpr double kFewFolds = 4e-4;
// What a thousand charges fold is near what the whole fit does, where that is so much: no need to
// go on to it.
constexpr double kHopelessFolds = 2 * kManyFolds;
constexpr double kWorthIt = 0.2;       // of one map's folds may be left by steps
constexpr double kSumAccuracy = 1e-7;  // of the target's diagonal, of what is checked inside
constexpr PointCounts kVertexTrial{kFirstSources, 4 * kFirstSources, kFirstSources};

PointCounts pointCounts(const ShellSettings& shell) {
  PointCounts counts;
  counts.sources = shell.sources;
  counts.collocation = shellCollocation(shell);
  counts.heldOut = std::clamp<std::size_t>(counts.sources, 1000, 5000);
  return counts;
}

// What is known of a fit before it becomes a MapFit.
struct Outcome {
  ComposedMap map;
  BoundaryError error;
  MapCertificate certificate;
  double collocationError = 0;
  bool smooth = false;
  std::optional<double> verticesRms;
  std::optional<ToleranceOutcome> tolerance;
  MapSolve solve;
  InsideFigures inside;
  std::vector<MapStep> steps;
};

// A fit with a number of charges.
Outcome outcomeOf(const FitResult& fit, const FitProblem& problem, const ShellSettings& shell) {
  const BoundaryData& data = fit.smooth ? problem.vertices : problem.surface;
  Outcome out{HarmonicMap(fit.field), {}, {}, 0, fit.smooth, {}, {}, {}, {}, {}};
  MapSolve& s = out.solve;
  s.method = fit.iterative                                  ? "iterative"
             : shell.method == Regularization::truncatedSvd ? "tsvd"
                                                            : "tikhonov";
  s.placement = shell.radiusRatio ? "sphere" : "shell";
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
Outcome outcomeOf(const AdaptiveResult& fit, double unit) {
  Outcome out{HarmonicMap(fit.field), fit.error, {}, 0, false, {}, {}, {}, {}, {}};
  out.collocationError =
      std::pow(fit.residuals.back() / unit, 2) * static_cast<double>(fit.collocation);
  MapSolve& s = out.solve;
  s.method = s.placement = "adaptive";
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
  fit.maxMemory = settings.maxMemory;
  fit.progress = settings.progress;
  return fit;
}

class MapFitter {
 public:
  MapFitter(const BoundaryPair& pair, const FitMapSettings& settings)
      : pair_(pair), settings_(settings) {}

  StageSeconds seconds;
  // Of one harmonic map, when there are steps instead.
  double singleFolded = 0;
  std::size_t singleSources = 0;
  std::vector<std::string> warnings;

  Outcome onShell(const ShellSettings& shell) {
    const FitProblem problem = problemOf(pointCounts(shell));
    const FitResult fit =
        timed(seconds, "fit", [&] { return fitField(problem, fitSettings(shell, settings_)); });
    Outcome out = outcomeOf(fit, problem, shell);
    certify(out);
    measure(problem, out);
    return out;
  }

  // mayStop: with the first charges, if these leave no doubt that steps are needed.
  Outcome within(double tolerance, bool mayStop = true) {
    std::optional<Outcome> out = tryVertices(tolerance);
    AdaptiveEnd end = AdaptiveEnd::met;
    if (!out) {
      AdaptiveSettings settings = adaptiveSettings(tolerance);
      if (mayStop && mayTakeSteps())
        settings.goOn = [this](const HarmonicField& field) {
          return foldedShare(insideOf(HarmonicMap(field)).determinants) <= kHopelessFolds;
        };
      timed(seconds, "fit", [&] {
        const AdaptiveResult fit = fitToTolerance(problem(), settings);
        end = fit.end;
        out.emplace(outcomeOf(fit, pair_.target.diagonal));
      });
      if (end != AdaptiveEnd::stopped) certify(*out);
    }
    out->tolerance = ToleranceOutcome{tolerance, out->error.p99, out->error.p99 <= tolerance, end};
    return std::move(*out);
  }

  // Counts folds, and goes in steps where there are too many.
  void check(Outcome& out) {
    if (settings_.oneToOne == OneToOne::off) return;
    timed(seconds, "inside", [&] {
      target_.emplace(pair_);
      out.inside = figuresOf(out);
    });
    if (!mayTakeSteps()) return;
    const bool on = settings_.oneToOne == OneToOne::on;
    if (out.inside.folded <= (on ? 0 : kManyFolds) && out.inside.outside <= kManyOutside) return;
    singleFolded = out.inside.folded;
    singleSources = out.solve.sources;
    if (!roomForSteps()) return finishSingle(out);
    Outcome steps = inSteps();
    if (steps.inside.folded <= (on ? 1 : kWorthIt) * singleFolded)
      out = std::move(steps);
    else
      finishSingle(out);
  }

  // After check().
  Injectivity injectivityOf(const Outcome& out) {
    Injectivity known;
    known.source = selfIntersectionFigures(pair_.source.check);
    known.target = selfIntersectionFigures(pair_.targetCheck);
    if (settings_.oneToOne == OneToOne::off) return known;
    BoundaryCheckSettings s;
    s.error = out.error.max * pair_.target.diagonal;
    s.accuracy = kSumAccuracy * pair_.target.diagonal;
    s.seed = settings_.seed;
    s.progress = settings_.progress;
    timed(seconds, "inside", [&] {
      known.inside = out.inside.determinants;
      known.outside = out.inside.outside;
      known.boundary = boundaryDeterminants(out.map, pair_, *target_, s);
      known.boundaryError = out.error.max;
      known.degree = boundaryDegree(out.map, pair_, *target_, s);
    });
    return known;
  }

 private:
  // Onto a target that is turned inside out somewhere no map is one-to-one.
  bool mayTakeSteps() const {
    return settings_.oneToOne != OneToOne::off && !settings_.shell && pair_.target.volume > 0;
  }

  const Points& inside() {
    if (inside_.empty()) inside_ = pointsInside(pair_.solid(), kInside, settings_.progress);
    return inside_;
  }

  MappedPoints insideOf(const ComposedMap& map) {
    return mapPoints(map, inside(), kSumAccuracy * pair_.target.diagonal, settings_.progress);
  }

  bool roomForSteps() {
    const std::uint64_t need = processMemory(kStepsMemory);
    if (settings_.maxMemory == 0 || need <= settings_.maxMemory) return true;
    warnings.push_back(
        fmt::format("one harmonic map folds {:.2g}% of the inside; going in steps may need about "
                    "{}, more than the limit of {}, so that is left",
                    100 * singleFolded, formatBytes(need), formatBytes(settings_.maxMemory)));
    return false;
  }

  // Where the fit ended with its first charges, for steps that are not taken.
  void finishSingle(Outcome& out) {
    if (out.tolerance->end != AdaptiveEnd::stopped) return;
    out = within(settings_.tolerance, false);
    timed(seconds, "inside", [&] { out.inside = figuresOf(out); });
  }

  SurfaceValues values() const {
    return [this](const std::vector<SurfacePoint>& points) { return pair_.targetsOf(points); };
  }

  AdaptiveProblem problem() const {
    AdaptiveProblemSettings s;
    s.seed = settings_.seed;
    s.progress = settings_.progress;
    return adaptiveProblem(pair_.solid(), values(), pair_.target.diagonal, s);
  }

  FitProblem problemOf(const PointCounts& counts) {
    PairProblemSettings s;
    s.counts = counts;
    s.vertices = settings_.interpolation != Interpolation::linear;
    if (settings_.shell) s.radiusRatio = settings_.shell->radiusRatio;
    s.seed = settings_.seed;
    s.progress = settings_.progress;
    return timed(seconds, "sample", [&] { return pairProblem(pair_, s); });
  }

  AdaptiveSettings adaptiveSettings(double tolerance) const {
    AdaptiveSettings s;
    s.tolerance = tolerance;
    s.maxSources = settings_.maxSources;
    s.checkSamples = kFreshSamples;
    s.maxMemory = memoryLeft(settings_.maxMemory);
    s.progress = settings_.progress;
    return s;
  }

  InsideFigures figuresOf(const Outcome& out) {
    const double slack = out.error.max * pair_.target.diagonal;
    const MappedPoints here = insideOf(out.map);
    InsideFigures figures;
    figures.samples = inside_.size();
    figures.folded = foldedShare(here.determinants);
    figures.determinants = determinantsOf(here, *target_, slack);
    for (std::size_t i = 0; i < inside_.size() && figures.foldedAt.size() < kPlaces; ++i)
      if (!(here.determinants[i] > 0)) figures.foldedAt.push_back(inside_[i]);
    figures.outside = outsideShare(here.points, *target_, slack, settings_.progress);
    return figures;
  }

  Outcome inSteps() {
    StepFitSettings s;
    s.tolerance = settings_.tolerance;
    s.folds = settings_.oneToOne == OneToOne::on ? 0 : kFewFolds;
    s.maxSteps = settings_.maxSteps;
    s.maxSources = settings_.maxSources;
    s.seed = settings_.seed;
    s.maxMemory = memoryLeft(settings_.maxMemory);
    s.progress = settings_.progress;
    StepFit fit = timed(seconds, "steps", [&] { return fitInSteps(pair_, inside(), s); });
    Outcome out{std::move(fit.map), fit.error, {}, 0, false, {}, {}, {}, {}, std::move(fit.steps)};
    out.solve.method = out.solve.placement = "steps";
    out.solve.sources = out.solve.rank = out.map.sources();
    certify(out);
    timed(seconds, "inside", [&] { out.inside = figuresOf(out); });
    out.tolerance =
        ToleranceOutcome{settings_.tolerance, out.error.p99, out.error.p99 <= settings_.tolerance,
                         fit.end == AdaptiveEnd::met ? AdaptiveEnd::noGain : fit.end};
    return out;
  }

  // Where vertices sample a smooth deformation, a fit to them is far more exact, and quick.
  std::optional<Outcome> tryVertices(double tolerance) {
    if (settings_.interpolation == Interpolation::linear) return {};
    const FitProblem problem = problemOf(kVertexTrial);
    ShellSettings shell;
    shell.sources = kVertexTrial.sources;
    FitSettings fitting = fitSettings(shell, settings_);
    fitting.trialSources = kTrialSources;
    const std::optional<FitResult> fit =
        timed(seconds, "fit", [&] { return fitSmooth(problem, fitting); });
    if (!fit) return {};
    Outcome out = outcomeOf(*fit, problem, shell);
    certify(out);
    if (out.error.p99 > tolerance && settings_.interpolation == Interpolation::automatic) return {};
    measure(problem, out);
    return out;
  }

  // With a number of charges, after certify(): at the points of the fit.
  void measure(const FitProblem& problem, Outcome& out) {
    timed(seconds, "certificate", [&] {
      BoundaryErrorSettings e;
      e.accuracy = out.certificate.accuracy;
      e.progress = settings_.progress;
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
  void certify(Outcome& out) {
    MapCertificateSettings s;
    s.smooth = out.smooth;
    s.seed = settings_.seed;
    s.progress = settings_.progress;
    out.certificate = timed(seconds, "certificate", [&] { return certifyMap(out.map, pair_, s); });
    BoundaryError error = out.certificate.error;
    if (out.error.samples > 0) {
      error.rms = out.error.rms;
      error.p99 = out.error.p99;
      error.sumOfSquares = out.error.sumOfSquares;
    }
    out.error = error;
  }

  const BoundaryPair& pair_;
  const FitMapSettings& settings_;
  Points inside_;
  std::optional<TargetShape> target_;
};

std::string number(double x) { return fmt::format("{:.9g}", x); }

Facts factsOf(const BoundaryPair& pair, const Outcome& out, std::uint64_t seed) {
  const auto oneLine = [](std::string text) {
    std::replace_if(
        text.begin(), text.end(), [](char c) { return c == '\n' || c == '\r'; }, '_');
    return text;
  };
  Facts facts{{"version", versionText()},
              {"source", oneLine(pair.source.mesh.name)},
              {"target", oneLine(pair.targetMesh.name)},
              {"method", out.solve.method},
              {"interpolation", out.smooth ? "smooth" : "linear"},
              {"seed", std::to_string(seed)},
              {"regularization", number(out.solve.regularization)},
              {"rank", std::to_string(out.solve.rank)},
              {"boundary_error_rms", number(out.error.rms)},
              {"boundary_error_p99", number(out.error.p99)},
              {"boundary_error_max", number(out.error.max)},
              {"boundary_error_samples", std::to_string(out.error.samples)},
              {"boundary_error_p99_bound", number(out.error.p99Bound)},
              {"boundary_error_bound", number(out.error.bound)},
              {"boundary_error_confidence", number(kCertificateConfidence)},
              {"boundary_error_smooth_bound", number(out.certificate.smoothBound)},
              {"c_error", number(out.collocationError)}};
  if (out.solve.radiusRatio > 0)
    facts.emplace_back("radius_ratio", number(out.solve.radiusRatio));
  else
    facts.emplace_back("distance", number(out.solve.distance));
  if (out.smooth)
    facts.emplace_back("boundary_error_vertices_max", number(out.certificate.verticesMax));
  else
    facts.emplace_back("boundary_error_triangles", number(out.certificate.triangles));
  if (!out.steps.empty()) facts.emplace_back("steps", std::to_string(out.steps.size()));
  if (out.inside.samples > 0) facts.emplace_back("folded", number(out.inside.folded));
  if (out.tolerance) {
    facts.emplace_back("tolerance", number(out.tolerance->wanted));
    facts.emplace_back("tolerance_reached", number(out.tolerance->reached));
    facts.emplace_back("tolerance_met", out.tolerance->met ? "true" : "false");
  }
  return facts;
}

void noteSteps(MapFit& fit, double singleFolded, std::size_t singleSources) {
  if (fit.steps.empty()) return;
  fit.notes.push_back(fmt::format(
      "one harmonic map, of {} charges, folds {:.2g}% of the inside; in {} steps {:.2g}% is folded "
      "and {:.2g}% taken out of the target",
      singleSources, 100 * singleFolded, fit.steps.size(), 100 * fit.inside.folded,
      100 * fit.inside.outside));
}

void noteProducts(MapFit& fit) {
  if (fit.solve.productError > 0)
    fit.notes.push_back(
        fmt::format("the charges nearly cancel: their sums were exact to {:.1g} of the values, as "
                    "far as rounding lets them be; more collocation points a charge help",
                    fit.solve.productError));
}

void warnOfError(MapFit& fit) {
  if (fit.error.max > kDoubtfulError)
    fit.warnings.push_back(
        fmt::format("the boundary error reaches {:.2g} of the diagonal: this map is not to be "
                    "trusted; use {}",
                    fit.error.max, fit.tolerance ? "a smaller tolerance" : "more charges"));
}

void validate(const FitMapSettings& settings) {
  if (settings.maxSteps < 1 || settings.maxSteps > 256)
    throw SettingError("maxSteps", "must lie in [1, 256]");
  if (settings.shell && settings.oneToOne == OneToOne::on)
    throw SettingError("oneToOne",
                       "steps are fitted to a tolerance; leave out the number of charges");
  if (!settings.shell) {
    if (!(settings.tolerance >= kSmallestTolerance && settings.tolerance <= 1))
      throw SettingError("tolerance", fmt::format("must lie in [{:g}, 1], not {:g}",
                                                  kSmallestTolerance, settings.tolerance));
    return;
  }
  const ShellSettings& shell = *settings.shell;
  if (shell.distance && shell.radiusRatio)
    throw SettingError("distance", "goes with a shell, radiusRatio with a sphere; give one");
  if (shell.collocation > 0 && shell.collocation < shell.sources + 4)
    throw SettingError("collocation",
                       fmt::format("must be at least {} for {} charges, not {}", shell.sources + 4,
                                   shell.sources, shell.collocation));
}

}  // namespace

std::size_t shellCollocation(const ShellSettings& shell) {
  if (shell.collocation > 0) return shell.collocation;
  const double perSource =
      shell.sources > kMostDenseSources ? kPointsPerManySources : kPointsPerSource;
  return static_cast<std::size_t>(std::max(perSource * static_cast<double>(shell.sources), 16.0));
}

std::uint64_t fitMapMemory(const FitMapSettings& settings, std::size_t vertices) {
  // Measured, bytes: the certificate and the look at the inside, of a vertex and at least.
  constexpr std::uint64_t kVertex = 1700, kChecks = 40'000'000;
  PointCounts counts{kFirstSources, 4 * kFirstSources, kFirstSources};
  FitSolver solver = FitSolver::dense;
  if (settings.shell) {
    counts = pointCounts(*settings.shell);
    if (!settings.shell->radiusRatio) solver = settings.shell->solver;
  }
  // Blue noise thins five candidates a point; each costs some 100 bytes.
  return std::max(fitMemory(counts.collocation, counts.sources, counts.heldOut, solver) +
                      500 * (counts.collocation + counts.sources) + 200 * kFreshSamples,
                  kChecks + kVertex * vertices);
}

MapFit fitMap(BoundaryPair boundary, const FitMapSettings& settings) {
  validate(settings);
  MapFitter fitter(boundary, settings);
  Outcome out =
      settings.shell ? fitter.onShell(*settings.shell) : fitter.within(settings.tolerance);
  fitter.check(out);
  Injectivity known = fitter.injectivityOf(out);
  Facts facts = factsOf(boundary, out, settings.seed);
  const Facts checked = injectivityFacts(known);
  facts.insert(facts.end(), checked.begin(), checked.end());
  MapFit fit{{std::move(out.map), std::move(boundary), std::move(facts), std::move(known)},
             out.error,
             out.collocationError,
             out.smooth,
             out.verticesRms,
             out.smooth ? std::optional(out.certificate.verticesMax) : std::nullopt,
             out.smooth ? std::nullopt : std::optional(out.certificate.triangles),
             out.certificate.smoothBound,
             out.tolerance,
             std::move(out.solve),
             std::move(out.inside),
             std::move(out.steps),
             {},
             std::move(fitter.warnings),
             std::move(fitter.seconds)};
  noteProducts(fit);
  noteSteps(fit, fitter.singleFolded, fitter.singleSources);
  warnOfError(fit);
  return fit;
}

MapFit fitMap(const Mesh& source, const Mesh& target, const FitMapSettings& settings) {
  BoundarySettings boundary;
  boundary.progress = settings.progress;
  MapFit fit = fitMap(makeBoundaryPair(source, target, boundary), settings);
  fit.notes.insert(fit.notes.begin(), fit.boundary.notes.begin(), fit.boundary.notes.end());
  fit.warnings.insert(fit.warnings.begin(), fit.boundary.warnings.begin(),
                      fit.boundary.warnings.end());
  StageSeconds seconds = fit.boundary.seconds;
  addSeconds(seconds, fit.seconds);
  fit.seconds = std::move(seconds);
  return fit;
}

}  // namespace innermap
