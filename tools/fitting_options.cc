#include "fitting_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "innermap/core/memory.h"
#include "job_cost.h"

namespace innermap::tool {
namespace {

constexpr std::size_t kFirstSources = 1000;
constexpr double kMostSources = 1000000;

std::size_t countOf(double count, const char* option, double least, double most) {
  if (!(count >= least && count <= most))
    throw SettingError(option, fmt::format("gives {:.6g} points; it must give {:.6g} to {:.6g}",
                                           count, least, most));
  return static_cast<std::size_t>(count);
}

// The tolerance that charges are placed for; nothing where the options place a number of them.
std::optional<double> toleranceOf(const FittingOptions& o) {
  const std::pair<bool, const char*> uniform[] = {
      {o.sources.has_value(), "--sources"},
      {o.sourceRatio.has_value(), "--source-ratio"},
      {o.collocation.has_value(), "--collocation"},
      {o.collocationRatio.has_value(), "--collocation-ratio"},
      {o.shell.distance.has_value(), "--distance"},
      {o.shell.radiusRatio.has_value(), "--radius-ratio"},
      {o.shell.solver != FitSolver::automatic, "--solver"},
      {o.shell.method != Regularization::tikhonov, "--method"},
      {o.shell.regularization.has_value(), "--regularization"}};
  if (o.tolerance && !(*o.tolerance >= kSmallestTolerance && *o.tolerance <= 1))
    throw UsageError(fmt::format(
        "--tolerance: must lie in 1e-12 to 1 of the target's diagonal, not {:g}; sums in double "
        "precision hold no less than 1e-12",
        *o.tolerance));
  for (const auto& [given, name] : uniform) {
    if (!given) continue;
    if (o.tolerance)
      throw UsageError(
          fmt::format("--tolerance and {} exclude each other; give one of them", name));
    return {};
  }
  return o.tolerance.value_or(o.fit.tolerance);
}

ShellSettings shellSettings(const FittingOptions& o, std::size_t vertices) {
  if (o.shell.distance && o.shell.radiusRatio)
    throw UsageError("--distance and --radius-ratio exclude each other; give one of them");
  if (o.collocation && o.collocationRatio)
    throw UsageError("--collocation and --collocation-ratio exclude each other; give one of them");
  const double v = static_cast<double>(vertices);
  ShellSettings shell = o.shell;
  shell.sources = o.sourceRatio
                      ? countOf(std::round(*o.sourceRatio * v), "--source-ratio", 1, kMostSources)
                      : o.sources.value_or(shell.sources);
  if (o.collocation || o.collocationRatio)
    shell.collocation = countOf(
        o.collocation ? static_cast<double>(*o.collocation) : std::round(*o.collocationRatio * v),
        o.collocationRatio ? "--collocation-ratio" : "--collocation",
        static_cast<double>(shell.sources) + 4, 1e7);
  return shell;
}

}  // namespace

void addFittingOptions(Command& command, FittingOptions& o) {
  command.group("fit of the map");
  command
      .option("--tolerance", "T", &o.tolerance,
              "charges are placed where the error is until 99% of the boundary lies within T; not "
              "with the options that place a number of them")
      .unit("fraction of the target's diagonal; from 1e-12 to 1")
      .defaults("0.001; 0.002 where one mesh is laid onto the other first");
  command.flag("--best-effort", &o.bestEffort,
               "exit code 0 also when the tolerance cannot be met; files are written either way");
  command.option("--max-sources", "N", &o.fit.maxSources, "charges that --tolerance may take")
      .range(kFirstSources, kMostSources)
      .advanced();
  command
      .option("--sources", "N", &o.sources,
              "number of charges on one shell, in place of --tolerance")
      .range(1, kMostSources)
      .defaults(fmt::format("{} when other options ask for such a shell", o.shell.sources));
  command.option("--collocation", "N", &o.collocation, "boundary points that the map is fitted to")
      .range(8, 1e7)
      .defaults("4 a source; 3 a source above 3000")
      .advanced();
  command
      .option("--source-ratio", "R", &o.sourceRatio,
              "charges as a multiple of the source's vertices (sRatio), in place of --sources")
      .above(0)
      .atMost(100)
      .advanced();
  command
      .option("--collocation-ratio", "R", &o.collocationRatio,
              "boundary points as a multiple of the source's vertices (cRatio), in place of "
              "--collocation")
      .above(0)
      .atMost(1000)
      .advanced();
  command
      .option("--distance", "D", &o.shell.distance, "of the charges from the surface (O-Distance)")
      .unit("fraction of the source's diagonal")
      .range(1e-4, 2)
      .defaults("chosen by held-out error")
      .advanced();
  command
      .option("--radius-ratio", "R", &o.shell.radiusRatio,
              "charges on a sphere, in place of a shell: its radius as a multiple of half the "
              "diagonal (R-Ratio)")
      .above(1)
      .atMost(100)
      .advanced();
  command
      .choice("--solver", "NAME", &o.shell.solver,
              {{"auto", FitSolver::automatic},
               {"dense", FitSolver::dense},
               {"iterative", FitSolver::iterative}},
              "dense: all at once, for up to some 3000 charges; iterative: for many; auto: by "
              "their number")
      .advanced();
  command
      .choice("--interpolation", "NAME", &o.fit.interpolation,
              {{"auto", Interpolation::automatic},
               {"linear", Interpolation::linear},
               {"smooth", Interpolation::smooth}},
              "what the target is between vertices: linear, as its triangles; smooth, when "
              "vertices sample a smooth deformation; auto: by the error at held-out vertices")
      .advanced();
  command.choice(
      "--one-to-one", "WHEN", &o.fit.oneToOne,
      {{"auto", OneToOne::automatic}, {"on", OneToOne::on}, {"off", OneToOne::off}},
      fmt::format("go in steps through intermediate shapes where one harmonic map folds; "
                  "auto: where it folds over {:g}% of the inside or takes over {:g}% of "
                  "it out of the target; on: until nothing that is checked folds, else "
                  "exit code 1; off: one harmonic map",
                  100 * kManyFolds, 100 * kManyOutside));
  command.option("--max-steps", "N", &o.fit.maxSteps, "steps at most").range(1, 256).advanced();
  command
      .choice("--method", "NAME", &o.shell.method,
              {{"tikhonov", Regularization::tikhonov}, {"tsvd", Regularization::truncatedSvd}},
              "regularisation: Tikhonov's, or truncation of singular values (the paper's)")
      .advanced();
  command
      .option("--regularization", "T", &o.shell.regularization,
              "threshold of singular values, or Tikhonov's lambda")
      .unit("fraction of the largest singular value")
      .range(0, 1)
      .defaults("chosen by held-out error")
      .advanced();
  command.option("--seed", "N", &o.fit.seed, "of all random points").range(0, 1e15).advanced();
}

FitMapSettings fitMapSettings(const FittingOptions& options, std::size_t vertices) {
  auto settings = options.fit;
  if (const auto tolerance = toleranceOf(options))
    settings.tolerance = *tolerance;
  else
    settings.shell = shellSettings(options, vertices);
  return settings;
}

void checkFittingOptions(const FittingOptions& options) { toleranceOf(options); }

std::string fittingPlan(const FitMapSettings& settings) {
  if (!settings.shell)
    return fmt::format("fit up to {} charges until 99% of the boundary lies within {:g}",
                       settings.maxSources, settings.tolerance);
  return fmt::format("fit {} charges to {} boundary points", settings.shell->sources,
                     shellCollocation(*settings.shell));
}

void requireFittingMemory(const FitMapSettings& settings, std::size_t vertices,
                          const Context& context) {
  const std::uint64_t bytes = fitMapMemory(settings, vertices);
  if (!settings.shell)
    return context.requireMemory("the first level of charges", bytes, "raise --max-memory");
  const double points = static_cast<double>(shellCollocation(*settings.shell)) /
                        static_cast<double>(settings.shell->sources);
  const auto need = [&](std::uint64_t sources) {
    FitMapSettings fewer = settings;
    fewer.shell->sources = sources;
    fewer.shell->collocation = static_cast<std::size_t>(points * static_cast<double>(sources));
    return fitMapMemory(fewer, vertices);
  };
  context.requireMemory(fmt::format("fitting {} sources", settings.shell->sources), bytes,
                        {"--sources", 1, settings.shell->sources, need}, "raise --max-memory");
}

// The more charges, the more rounds until they do.
constexpr double kRoundsPower = 1.4;

std::vector<JobPhase> fittingPhases(const FitMapSettings& settings, double places, bool laidOn) {
  JobSize size;
  if (settings.shell) {
    const double sources = static_cast<double>(settings.shell->sources) / 1000;
    size.items = sources <= 3 ? 0.25 * std::pow(sources, 2.5) : 1.5 * sources;
    return {stageOf("fitting: a shell", size)};
  }
  size.items = std::pow(places, kRoundsPower);
  std::vector<JobPhase> phases = {stageOf("fitting", size),
                                  stageOf("meeting the tolerance", size, 1, "fitting")};
  if (settings.oneToOne == OneToOne::off) return phases;
  size.items = places;
  phases.push_back(stageOf("going in steps", size));
  phases.back().perhaps = !laidOn;
  return phases;
}

}  // namespace innermap::tool
