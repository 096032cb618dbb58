#include "fitting.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "boundary_samples.h"
#include "innermap/io/version.h"

namespace innermap::tool {
namespace {

// How the field was found: by a FitResult or an AdaptiveResult.
struct Outcome {
  HarmonicField field;
  ReportSolve solve;
  bool smooth = false;
  BoundaryError error;                                       // at fresh points
  double cError = 0;                                         // sum of squares at collocation points
  std::vector<std::pair<std::string, ReportValue>> details;  // of the report's "solve"
  Settings settings;                                         // of the map's file
};

std::string number(double x) { return fmt::format("{:.9g}", x); }

void addTrials(const FitResult& fit, Outcome& out) {
  std::vector<double> distances, errors;
  for (const DistanceTrial& t : fit.trials) {
    distances.push_back(t.distance);
    errors.push_back(t.heldOutRms);
  }
  if (distances.empty()) return;
  out.details.emplace_back("tried_distances", distances);
  out.details.emplace_back("tried_errors", errors);
}

// A fit with a given number of charges.
Outcome outcomeOf(const FitResult& fit, const FitProblem& problem, const FittingOptions& options) {
  const BoundaryData& data = fit.smooth ? problem.vertices : problem.surface;
  Outcome out{fit.field, {}, fit.smooth, {}, 0, {}, {}};
  out.solve.method = fit.iterative ? "iterative" : options.method;
  out.solve.sources = fit.field.sources().size();
  out.solve.collocation = data.points.size();
  out.solve.rank = fit.rank;
  out.solve.regularization = fit.regularization;
  out.solve.iterations = fit.iterative ? static_cast<int>(fit.residuals.size()) - 1 : 0;
  out.details.emplace_back("placement", options.radiusRatio ? "sphere" : "shell");
  if (options.radiusRatio) {
    out.details.emplace_back("radius_ratio", *options.radiusRatio);
    out.settings.emplace_back("radius_ratio", number(*options.radiusRatio));
  } else {
    out.details.emplace_back("distance", fit.distance);
    out.settings.emplace_back("distance", number(fit.distance));
  }
  if (fit.iterative)
    out.details.emplace_back("residuals", fit.residuals);
  else
    out.details.emplace_back("condition", fit.condition);
  out.details.emplace_back("weight_norm", fit.weightNorm);
  out.details.emplace_back("held_out", static_cast<std::int64_t>(data.heldOut.size()));
  addTrials(fit, out);
  return out;
}

// A fit to a tolerance.
Outcome outcomeOf(const AdaptiveResult& fit, double unit) {
  Outcome out{fit.field, {}, false, fit.error, 0, {}, {}};
  out.solve.method = "adaptive";
  out.solve.sources = out.solve.rank = fit.field.sources().size();
  out.solve.collocation = fit.collocation;
  out.solve.iterations = static_cast<int>(fit.residuals.size()) - 1;
  out.cError = std::pow(fit.residuals.back() / unit, 2) * static_cast<double>(fit.collocation);
  std::vector<double> distances, sources, roundSources, roundErrors;
  for (const AdaptiveLevel& l : fit.levels) {
    distances.push_back(l.distance);
    sources.push_back(static_cast<double>(l.sources));
  }
  for (const AdaptiveRound& r : fit.rounds) {
    roundSources.push_back(static_cast<double>(r.sources));
    roundErrors.push_back(r.error.p99);
  }
  out.details = {{"placement", "adaptive"},       {"distance", distances.front()},
                 {"level_distances", distances},  {"level_sources", sources},
                 {"round_sources", roundSources}, {"round_p99", roundErrors},
                 {"residuals", fit.residuals},    {"weight_norm", fit.weightNorm}};
  out.settings.emplace_back("distance", number(distances.front()));
  return out;
}

void measure(const BoundaryPair& pair, const FitProblem& problem, const FittingOptions& options,
             Outcome& out, Context& context) {
  context.timed("certificate", [&] {
    const auto error = [&](const Points& points, const Matrix& values) {
      return measureBoundaryError(out.field, points, values, pair.targetDiagonal,
                                  {0, context.progress()});
    };
    const BoundarySamples fresh = freshSamples(pair, options, context);
    out.error = error(fresh.points, fresh.values);
    const BoundaryData& data = out.smooth ? problem.vertices : problem.surface;
    out.cError = error(data.points, data.values).sumOfSquares;
    if (out.smooth)
      context.report().set("boundary_error.vertices_rms",
                           error(data.heldOut, data.heldOutValues).rms);
  });
}

FitSettings fitSettings(const FittingOptions& options, const PointCounts& counts,
                        Context& context) {
  FitSettings settings;
  settings.sources = counts.sources;
  settings.solver = solverOf(options);
  settings.interpolation = options.interpolation == "auto"     ? Interpolation::automatic
                           : options.interpolation == "linear" ? Interpolation::linear
                                                               : Interpolation::smooth;
  settings.distance = options.distance;
  // On a sphere the distance plays no part: one fit, nothing to choose.
  if (options.radiusRatio) settings.distance = 1.0;
  settings.method =
      options.method == "tsvd" ? Regularization::truncatedSvd : Regularization::tikhonov;
  settings.regularization = options.regularization;
  settings.maxMemory = context.maxMemory();
  settings.progress = context.progress();
  return settings;
}

Outcome fitOnShell(const BoundaryPair& pair, const FittingOptions& options, Context& context) {
  const PointCounts counts = pointCounts(options, pair.source.vertices.size());
  FitProblem problem;
  context.timed("sample", [&] { problem = fitProblem(pair, options, counts, context); });
  std::optional<FitResult> fit;
  context.timed("fit",
                [&] { fit.emplace(fitField(problem, fitSettings(options, counts, context))); });
  Outcome out = outcomeOf(*fit, problem, options);
  measure(pair, problem, options, out, context);
  return out;
}

// Where vertices sample a smooth deformation, a fit to them is far more exact, and quick.
std::optional<Outcome> tryVertices(const BoundaryPair& pair, const FittingOptions& options,
                                   double tolerance, Context& context) {
  constexpr std::size_t kSources = 1000, kTrialSources = 200;
  if (options.interpolation == "linear") return {};
  const PointCounts counts{kSources, 4 * kSources, kSources};
  FitProblem problem;
  context.timed("sample", [&] { problem = fitProblem(pair, options, counts, context); });
  FitSettings settings = fitSettings(options, counts, context);
  settings.trialSources = kTrialSources;
  std::optional<FitResult> fit;
  context.timed("fit", [&] { fit = fitSmooth(problem, settings); });
  if (!fit) return {};
  Outcome out = outcomeOf(*fit, problem, options);
  measure(pair, problem, options, out, context);
  if (out.error.p99 > tolerance && options.interpolation == "auto") return {};
  return out;
}

std::string whyEnded(AdaptiveEnd end, const FittingOptions& options) {
  switch (end) {
    case AdaptiveEnd::maxSources:
      return fmt::format("--max-sources {} is reached", options.maxSources);
    case AdaptiveEnd::maxMemory:
      return "--max-memory is reached";
    case AdaptiveEnd::noGain:
      return "more charges do not help";
    case AdaptiveEnd::met:
      break;
  }
  return "vertices are all that --interpolation smooth fits";
}

void sayNotMet(const Outcome& out, double tolerance, const std::string& why,
               const FittingOptions& options, Context& context) {
  const std::string text = fmt::format(
      "--tolerance {:g} is not met: 99% of the boundary lies within {:.3g} of the target's "
      "diagonal, with {} charges; {}",
      tolerance, out.error.p99, out.solve.sources, why);
  if (options.bestEffort)
    context.warning(text);
  else
    context.failAfterwards(text + "; what is written is marked so (--best-effort: exit code 0)");
}

Outcome fitWithin(double tolerance, const BoundaryPair& pair, const FittingOptions& options,
                  Context& context) {
  std::optional<Outcome> out = tryVertices(pair, options, tolerance, context);
  AdaptiveEnd end = AdaptiveEnd::met;
  if (!out) {
    AdaptiveSettings settings;
    settings.tolerance = tolerance;
    settings.maxSources = options.maxSources;
    settings.checkSamples = kFreshSamples;
    settings.maxMemory = context.maxMemory();
    settings.progress = context.progress();
    context.timed("fit", [&] {
      const AdaptiveResult fit = fitToTolerance(adaptiveProblem(pair, options, context), settings);
      end = fit.end;
      out.emplace(outcomeOf(fit, pair.targetDiagonal));
    });
  }
  const bool met = out->error.p99 <= tolerance;
  out->settings.emplace_back("tolerance", number(tolerance));
  out->settings.emplace_back("tolerance_reached", number(out->error.p99));
  out->settings.emplace_back("tolerance_met", met ? "true" : "false");
  context.report().set("tolerance.wanted", tolerance);
  context.report().set("tolerance.reached", out->error.p99);
  context.report().set("tolerance.met", met);
  if (!met) {
    const std::string why = whyEnded(end, options);
    context.report().set("tolerance.ended", why);
    sayNotMet(*out, tolerance, why, options, context);
  }
  return std::move(*out);
}

void fillReport(const Outcome& out, const FittingOptions& options, Report& report) {
  report.solve = out.solve;
  for (const auto& [key, value] : out.details) report.set("solve." + key, value);
  report.set("solve.interpolation", out.smooth ? "smooth" : "linear");
  report.set("solve.seed", static_cast<std::int64_t>(options.seed));
  ReportBoundaryError e;
  e.rms = out.error.rms;
  e.p99 = out.error.p99;
  e.max = out.error.max;
  e.samples = out.error.samples;
  e.cError = out.cError;
  report.boundaryError = e;
}

Settings describe(const BoundaryPair& pair, const Outcome& out, const FittingOptions& options) {
  const auto path = [](std::string text) {
    std::replace_if(
        text.begin(), text.end(), [](char c) { return c == '\n' || c == '\r'; }, '_');
    return text;
  };
  Settings settings{{"version", versionText()},
                    {"source", path(pair.source.name)},
                    {"target", path(pair.target.name)},
                    {"method", out.solve.method},
                    {"interpolation", out.smooth ? "smooth" : "linear"},
                    {"seed", std::to_string(options.seed)},
                    {"regularization", number(out.solve.regularization)},
                    {"rank", std::to_string(out.solve.rank)},
                    {"boundary_error_rms", number(out.error.rms)},
                    {"boundary_error_p99", number(out.error.p99)},
                    {"boundary_error_max", number(out.error.max)},
                    {"boundary_error_samples", std::to_string(out.error.samples)},
                    {"c_error", number(out.cError)}};
  settings.insert(settings.end(), out.settings.begin(), out.settings.end());
  return settings;
}

}  // namespace

Fitted fitMap(const BoundaryPair& pair, const FittingOptions& options, Context& context) {
  const std::optional<double> tolerance = toleranceOf(options);
  const Outcome out = tolerance ? fitWithin(*tolerance, pair, options, context)
                                : fitOnShell(pair, options, context);
  fillReport(out, options, context.report());
  if (out.error.max > 0.1)
    context.warning(
        fmt::format("the boundary error reaches {:.2g} of the diagonal: this map is not to be "
                    "trusted; use {}",
                    out.error.max, tolerance ? "a smaller --tolerance" : "more --sources"));
  return {{out.field, describe(pair, out, options), pair.source.vertices, pair.target.vertices,
           pair.source.triangles},
          out.error};
}

}  // namespace innermap::tool
