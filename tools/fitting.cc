#include "fitting.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "innermap/core/memory.h"
#include "innermap/core/random.h"
#include "innermap/field/fit.h"
#include "innermap/output/version.h"
#include "innermap/sample/source_points.h"
#include "innermap/sample/surface_samples.h"
#include "largest.h"

namespace innermap::tool {
namespace {

constexpr std::size_t kFreshSamples = 20000;
constexpr double kPointsPerSource = 4, kPointsPerSourceIterative = 3;
constexpr double kMostSources = 1000000;

// Seeds of the three sets of boundary points, so that none has a point of another.
enum Stream : std::uint64_t {
  kCollocation = 0,
  kHeldOut = 1,
  kFresh = 2,
  kSources = 3,
  kVertices = 4
};
FitSolver solverOf(const FittingOptions& options) {
  if (options.radiusRatio) return FitSolver::dense;  // far from most of the surface
  return options.solver == "auto"    ? FitSolver::automatic
         : options.solver == "dense" ? FitSolver::dense
                                     : FitSolver::iterative;
}

Interpolation interpolationOf(const FittingOptions& options) {
  return options.interpolation == "linear"   ? Interpolation::linear
         : options.interpolation == "smooth" ? Interpolation::smooth
                                             : Interpolation::automatic;
}

std::uint64_t seedOf(const FittingOptions& options, Stream stream) {
  return 4 * options.seed + stream;
}

Points positionsOf(const Mesh& mesh, const std::vector<SurfacePoint>& samples) {
  return interpolate(mesh.vertices, mesh.triangles, samples);
}

using Samples = std::vector<SurfacePoint>;

BoundaryData surfaceData(const BoundaryPair& pair, const Samples& collocation,
                         const Samples& heldOut) {
  const Mesh& surface = pair.solid.surface();
  return {positionsOf(surface, collocation), positionsOf(surface, heldOut),
          pair.targetsOf(collocation), pair.targetsOf(heldOut)};
}

// Samples on caps, which have no vertices of the mesh's own.
Samples onCaps(const BoundaryPair& pair, const Samples& samples) {
  Samples out;
  for (const SurfacePoint& p : samples)
    if (pair.solid.repaired().parent[pair.solid.address(p).triangle] < 0) out.push_back(p);
  return out;
}

// The mesh's own vertices on the boundary (not buried ones), shuffled, and samples of the caps; a
// fifth of the vertices is held out.
BoundaryData vertexData(const BoundaryPair& pair, const FittingOptions& options,
                        const PointCounts& counts, const Samples& collocation) {
  const Mesh& mesh = pair.solid.repaired().mesh;
  std::vector<char> used(pair.source.vertices.size(), 0);
  for (const Triangle& t : mesh.triangles)
    for (const int v : t)
      if (static_cast<std::size_t>(v) < used.size()) used[v] = 1;
  const double touching = 1e-9 * pair.solid.diagonal();
  std::vector<std::pair<std::uint64_t, std::size_t>> order;
  const CounterRandom random(options.seed, kVertices);
  for (std::size_t v = 0; v < used.size(); ++v)
    if (used[v] && (!pair.solid.overlaps() || pair.solid.distance(mesh.vertices[v]) <= touching))
      order.emplace_back(random.bits(v), v);
  std::sort(order.begin(), order.end());
  const std::size_t heldOut = std::min(order.size() / 5, counts.heldOut),
                    points = std::min(order.size() - heldOut, counts.collocation);
  const Samples caps = onCaps(pair, collocation);
  BoundaryData data{positionsOf(pair.solid.surface(), caps),
                    {},
                    Matrix(caps.size() + points, 3),
                    Matrix(heldOut, 3)};
  const Matrix capValues = pair.targetsOf(caps);
  for (std::size_t i = 0; i < caps.size(); ++i)
    for (int a = 0; a < 3; ++a) data.values(i, a) = capValues(i, a);
  const auto add = [&](std::size_t v, Points& to, Matrix& values) {
    for (int a = 0; a < 3; ++a) values(to.size(), a) = pair.moved[v][a];
    to.push_back(mesh.vertices[v]);
  };
  for (std::size_t i = 0; i < heldOut; ++i) add(order[i].second, data.heldOut, data.heldOutValues);
  for (std::size_t i = 0; i < points; ++i) add(order[heldOut + i].second, data.points, data.values);
  return data;
}

FitProblem makeProblem(const BoundaryPair& pair, const FittingOptions& options,
                       const PointCounts& counts, Context& context) {
  const Mesh& surface = pair.solid.surface();
  SampleSettings sample;
  sample.progress = context.progress();
  sample.seed = seedOf(options, kCollocation);
  const Samples collocation = blueNoiseSamples(surface, counts.collocation, sample);
  sample.seed = seedOf(options, kHeldOut);
  const Samples heldOut = randomSamples(surface, counts.heldOut, sample);
  FitProblem problem;
  problem.surface = surfaceData(pair, collocation, heldOut);
  if (options.interpolation != "linear")
    problem.vertices = vertexData(pair, options, counts, collocation);
  problem.diagonal = pair.solid.diagonal();
  problem.area = pair.solid.area();
  SourceSettings source;
  source.seed = seedOf(options, kSources);
  source.progress = context.progress();
  problem.placeSources = [&pair, &options, source](std::size_t count, double distance) mutable {
    source.count = count;
    return options.radiusRatio ? sourceSphere(pair.solid, *options.radiusRatio, source)
                               : sourceShell(pair.solid, distance, source);
  };
  return problem;
}

BoundaryError certify(const HarmonicField& field, const BoundaryPair& pair,
                      const FittingOptions& options, Context& context) {
  SampleSettings sample;
  sample.seed = seedOf(options, kFresh);
  sample.progress = context.progress();
  const auto fresh = randomSamples(pair.solid.surface(), kFreshSamples, sample);
  return measureBoundaryError(field, positionsOf(pair.solid.surface(), fresh),
                              pair.targetsOf(fresh), pair.targetDiagonal, context.progress());
}

std::string methodOf(const FitResult& fit, const FittingOptions& options) {
  return fit.iterative ? "iterative" : options.method;
}

void fillReport(const FitResult& fit, const FitProblem& problem, const BoundaryError& error,
                double cError, const FittingOptions& options, Context& context) {
  Report& report = context.report();
  const BoundaryData& data = fit.smooth ? problem.vertices : problem.surface;
  ReportSolve solve;
  solve.method = methodOf(fit, options);
  solve.sources = fit.field.sources().size();
  solve.collocation = data.points.size();
  solve.rank = fit.rank;
  solve.regularization = fit.regularization;
  solve.iterations = fit.iterative ? static_cast<int>(fit.residuals.size()) - 1 : 0;
  report.solve = solve;
  report.set("solve.placement", options.radiusRatio ? "sphere" : "shell");
  if (options.radiusRatio)
    report.set("solve.radius_ratio", *options.radiusRatio);
  else
    report.set("solve.distance", fit.distance);
  report.set("solve.interpolation", fit.smooth ? "smooth" : "linear");
  if (fit.iterative)
    report.set("solve.residuals", fit.residuals);
  else
    report.set("solve.condition", fit.condition);
  report.set("solve.weight_norm", fit.weightNorm);
  report.set("solve.held_out", static_cast<std::int64_t>(data.heldOut.size()));
  report.set("solve.seed", static_cast<std::int64_t>(options.seed));
  std::vector<double> distances, errors;
  for (const DistanceTrial& t : fit.trials) {
    distances.push_back(t.distance);
    errors.push_back(t.heldOutRms);
  }
  if (!distances.empty()) {
    report.set("solve.tried_distances", distances);
    report.set("solve.tried_errors", errors);
  }
  ReportBoundaryError e;
  e.rms = error.rms;
  e.p99 = error.p99;
  e.max = error.max;
  e.samples = error.samples;
  e.cError = cError;
  report.boundaryError = e;
}

Settings describe(const BoundaryPair& pair, const FitResult& fit, const BoundaryError& error,
                  double cError, const FittingOptions& options) {
  const auto number = [](double x) { return fmt::format("{:.9g}", x); };
  const auto path = [](std::string text) {
    std::replace_if(
        text.begin(), text.end(), [](char c) { return c == '\n' || c == '\r'; }, '_');
    return text;
  };
  Settings settings{{"version", versionText()},
                    {"source", path(pair.source.name)},
                    {"target", path(pair.target.name)},
                    {"method", methodOf(fit, options)},
                    {"interpolation", fit.smooth ? "smooth" : "linear"},
                    {"seed", std::to_string(options.seed)},
                    {"regularization", number(fit.regularization)},
                    {"rank", std::to_string(fit.rank)},
                    {"boundary_error_rms", number(error.rms)},
                    {"boundary_error_p99", number(error.p99)},
                    {"boundary_error_max", number(error.max)},
                    {"boundary_error_samples", std::to_string(error.samples)},
                    {"c_error", number(cError)}};
  if (options.radiusRatio)
    settings.emplace_back("radius_ratio", number(*options.radiusRatio));
  else
    settings.emplace_back("distance", number(fit.distance));
  return settings;
}

std::size_t countOf(double count, const char* option, double least, double most) {
  if (!(count >= least && count <= most))
    throw SettingError(option, fmt::format("gives {:.6g} points; it must give {:.6g} to {:.6g}",
                                           count, least, most));
  return static_cast<std::size_t>(count);
}

}  // namespace

void addFittingOptions(Command& command, FittingOptions& o) {
  command.option("--sources", "N", &o.sources, "number of charges").range(1, kMostSources);
  command.option("--collocation", "N", &o.collocation, "boundary points that the map is fitted to")
      .range(8, 1e7)
      .defaults("4 a source; iterative: 3");
  command
      .option("--source-ratio", "R", &o.sourceRatio,
              "charges as a multiple of the source's vertices (sRatio), in place of --sources")
      .above(0)
      .atMost(100);
  command
      .option("--collocation-ratio", "R", &o.collocationRatio,
              "boundary points as a multiple of the source's vertices (cRatio), in place of "
              "--collocation")
      .above(0)
      .atMost(1000);
  command.option("--distance", "D", &o.distance, "of the charges from the surface (O-Distance)")
      .unit("fraction of the source's diagonal")
      .range(1e-4, 2)
      .defaults("chosen by held-out error");
  command
      .option("--radius-ratio", "R", &o.radiusRatio,
              "charges on a sphere, in place of a shell: its radius as a multiple of half the "
              "diagonal (R-Ratio)")
      .above(1)
      .atMost(100);
  command
      .option(
          "--solver", "NAME", &o.solver,
          "dense: all at once, for up to some 3000 charges; iterative: for many; auto: by their "
          "number")
      .choices({"auto", "dense", "iterative"});
  command
      .option(
          "--interpolation", "NAME", &o.interpolation,
          "what the target is between vertices: linear, as its triangles; smooth, when vertices "
          "sample a smooth deformation; auto: by the error at held-out vertices")
      .choices({"auto", "linear", "smooth"});
  command
      .option("--method", "NAME", &o.method,
              "regularisation: Tikhonov's, or truncation of singular values (the paper's)")
      .choices({"tikhonov", "tsvd"});
  command
      .option("--regularization", "T", &o.regularization,
              "threshold of singular values, or Tikhonov's lambda")
      .unit("fraction of the largest singular value")
      .range(0, 1)
      .defaults("chosen by held-out error");
  command.option("--seed", "N", &o.seed, "of all random points").range(0, 1e15);
}

PointCounts pointCounts(const FittingOptions& o, std::size_t vertices) {
  if (o.distance && o.radiusRatio)
    throw UsageError("--distance and --radius-ratio exclude each other; give one of them");
  if (o.collocation && o.collocationRatio)
    throw UsageError("--collocation and --collocation-ratio exclude each other; give one of them");
  const double v = static_cast<double>(vertices);
  PointCounts counts;
  counts.sources = o.sourceRatio
                       ? countOf(std::round(*o.sourceRatio * v), "--source-ratio", 1, kMostSources)
                       : o.sources;
  const double n = static_cast<double>(counts.sources);
  const bool iterative =
      o.solver == "iterative" || (o.solver == "auto" && counts.sources > kMostDenseSources);
  const double perSource = iterative ? kPointsPerSourceIterative : kPointsPerSource;
  const double wanted = o.collocation        ? static_cast<double>(*o.collocation)
                        : o.collocationRatio ? std::round(*o.collocationRatio * v)
                                             : std::max(perSource * n, 16.0);
  counts.collocation =
      countOf(wanted, o.collocationRatio ? "--collocation-ratio" : "--collocation", n + 4, 1e7);
  counts.heldOut = std::clamp<std::size_t>(counts.sources, 1000, 5000);
  return counts;
}

std::uint64_t fittingMemory(const PointCounts& counts, const FittingOptions& options) {
  constexpr std::uint64_t kProgram = 64'000'000;  // with nothing loaded yet
  // Blue noise thins five candidates a point; each costs some 100 bytes.
  return kProgram +
         fitMemory(counts.collocation, counts.sources, counts.heldOut, solverOf(options)) +
         500 * (counts.collocation + counts.sources) + 200 * kFreshSamples;
}

void requireFittingMemory(const PointCounts& counts, const FittingOptions& options,
                          const Context& context) {
  const double points =
      static_cast<double>(counts.collocation) / static_cast<double>(counts.sources);
  const auto fits = [&](std::uint64_t sources) {
    PointCounts c;
    c.sources = sources;
    c.collocation = static_cast<std::size_t>(points * static_cast<double>(sources));
    c.heldOut = counts.heldOut;
    return fittingMemory(c, options) <= context.maxMemory();
  };
  const std::uint64_t most = largestThat(1, counts.sources, fits);
  requireMemory(fmt::format("fitting {} sources", counts.sources), fittingMemory(counts, options),
                context.maxMemory(),
                most > 0 ? fmt::format("use --sources {} or raise --max-memory", most)
                         : "raise --max-memory");
}

Fitted fitMap(const BoundaryPair& pair, const FittingOptions& options, Context& context) {
  const PointCounts counts = pointCounts(options, pair.source.vertices.size());
  FitProblem problem;
  context.timed("sample", [&] { problem = makeProblem(pair, options, counts, context); });
  FitSettings settings;
  settings.sources = counts.sources;
  settings.solver = solverOf(options);
  settings.interpolation = interpolationOf(options);
  settings.distance = options.distance;
  // On a sphere the distance plays no part: one fit, nothing to choose.
  if (options.radiusRatio) settings.distance = 1.0;
  settings.method =
      options.method == "tsvd" ? Regularization::truncatedSvd : Regularization::tikhonov;
  settings.regularization = options.regularization;
  settings.maxMemory = context.maxMemory();
  settings.progress = context.progress();
  std::optional<FitResult> fit;
  context.timed("fit", [&] { fit.emplace(fitField(problem, settings)); });
  BoundaryError error;
  double cError = 0;
  context.timed("certificate", [&] {
    error = certify(fit->field, pair, options, context);
    const BoundaryData& data = fit->smooth ? problem.vertices : problem.surface;
    cError = measureBoundaryError(fit->field, data.points, data.values, pair.targetDiagonal,
                                  context.progress())
                 .sumOfSquares;
    if (fit->smooth)
      context.report().set("boundary_error.vertices_rms",
                           measureBoundaryError(fit->field, data.heldOut, data.heldOutValues,
                                                pair.targetDiagonal, context.progress())
                               .rms);
  });
  fillReport(*fit, problem, error, cError, options, context);
  if (error.max > 0.1)
    context.warning(
        fmt::format("the boundary error reaches {:.2g} of the diagonal: this map is not to be "
                    "trusted; use more "
                    "--sources",
                    error.max));
  Fitted out{{fit->field, describe(pair, *fit, error, cError, options), pair.source.vertices,
              pair.target.vertices, pair.source.triangles},
             error};
  return out;
}

}  // namespace innermap::tool
