#include "verdict.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "innermap/field/field_file.h"
#include "report/figures.h"
#include "report_figures.h"

namespace innermap::tool {
namespace {

std::string percent(double share) { return fmt::format("{:.3g}%", 100 * share); }

ReportFinding finding(std::string name, std::string statement, double value, double threshold,
                      std::string advice) {
  ReportFinding out;
  out.name = std::move(name);
  out.statement = std::move(statement);
  out.value = value;
  out.threshold = threshold;
  out.met = value <= threshold;
  if (!out.met) out.advice = std::move(advice);
  return out;
}

bool usedOn(const Context& context, const std::string& setting) {
  const std::string* value = context.setting(setting);
  return value && *value == "on";
}

std::string boundaryAdvice(MapOrigin origin, bool toTolerance) {
  if (origin == MapOrigin::file)
    return "fit the map again with a smaller --tolerance, or more --charges";
  return toTolerance ? "more --max-charges or --max-memory, a finer or smoother mesh, or a larger "
                       "--tolerance"
                     : "--tolerance in place of a number of charges, or more --charges";
}

std::string foldAdvice(MapOrigin origin, bool toTolerance, const Context& context) {
  const std::string laid = ", pairs of places in --landmarks, or --aligned where both stand alike";
  if (origin == MapOrigin::file)
    return "fit the map again with --one-to-one on, a smaller --tolerance, or for solids that were "
           "never related --landmarks or --aligned";
  if (!toTolerance) return "--one-to-one on with --tolerance, in place of a number of charges";
  const std::string first = usedOn(context, "--one-to-one")
                                ? "more --max-steps, a smaller --tolerance"
                                : "--one-to-one on, a smaller --tolerance";
  return origin == MapOrigin::laidOn ? first + laid : first;
}

void judgeBoundary(const MappedSolid& mapped, MapOrigin origin, Context& context) {
  const FitFacts fit = fitFacts(mapped.facts);
  const double p99 = fit.error.p99;
  if (std::isnan(p99)) return;
  const bool toTolerance = fit.tolerance.has_value();
  const double tolerance = fit.tolerance.value_or(kUsualTolerance);
  ReportFinding f = finding("boundary",
                            fmt::format("99% of the boundary is within {:.2e} of the target's "
                                        "diagonal (wanted: {:g})",
                                        p99, tolerance),
                            p99, tolerance, boundaryAdvice(origin, toTolerance));
  // Of vertices alone where a smooth deformation is fitted; the fit has said how it ended.
  if (toTolerance && fit.met == false && f.met) {
    f.met = false;
    f.value = fit.reached.value_or(p99);
    f.advice = boundaryAdvice(origin, toTolerance);
  }
  context.judge(std::move(f), toTolerance && origin != MapOrigin::file);
}

std::string foldStatement(double folded, const DeterminantFigures& points, double threshold) {
  if (folded <= 0) return "nowhere folded inside: one-to-one as far as checked";
  std::string out = fmt::format("{} of the inside is folded (at most: {}): not one-to-one there",
                                percent(folded), percent(threshold));
  if (points.foldedAtOverlap > 0 && points.folded > 0)
    out += fmt::format(
        ", {} of that where the target runs through itself",
        percent(static_cast<double>(points.foldedAtOverlap) / static_cast<double>(points.folded)));
  return out;
}

void judgeCrossings(const MappedSolid& mapped, const VerdictOptions& options, Context& context) {
  const SelfIntersectionFigures& target = mapped.injectivity.target;
  const SelfIntersectionFigures& source = mapped.injectivity.source;
  std::string text = target.pairs == 0
                         ? "the target nowhere runs through itself"
                         : fmt::format(
                               "the target runs through itself: {} pair{} of triangles, "
                               "where no map is one-to-one",
                               target.pairs, target.pairs == 1 ? "" : "s");
  if (source.pairs > 0) text += fmt::format("; the source does, in {}", source.pairs);
  context.judge(finding("self_intersections", text, static_cast<double>(target.pairs),
                        static_cast<double>(options.maxCrossings),
                        "repair the target where `innermap check` places the crossings, or allow "
                        "them by --warn-crossings"),
                true);  // reading the boundaries warned of it
}

// A mirror's image is nowhere folded, though its determinants are negative.
double foldedOf(const Injectivity& known) {
  const DeterminantFigures& inside = known.inside;
  if (inside.checked == 0 || inside.folded == inside.checked) return 0;
  return static_cast<double>(inside.folded) / static_cast<double>(inside.checked);
}

void judgeOutside(double outside, const VerdictOptions& options, const std::string& advice,
                  Context& context) {
  context.report().add("", outsideFigures(outside));
  context.judge(finding("outside",
                        fmt::format("{} of the inside lands outside the target, by more than the "
                                    "boundary's error (at most: {})",
                                    percent(outside), percent(options.maxOutside)),
                        outside, options.maxOutside, advice));
}

std::string listOf(const std::vector<std::int64_t>& numbers) {
  constexpr std::size_t kMost = 12;
  const std::vector<std::int64_t> first(
      numbers.begin(),
      numbers.begin() + static_cast<std::ptrdiff_t>(std::min(kMost, numbers.size())));
  return fmt::format("{}{}", fmt::join(first, ", "), numbers.size() > kMost ? ", ..." : "");
}

}  // namespace

void addVerdictOptions(Command& c, VerdictOptions& o, bool frames) {
  c.option("--warn-folded", "SHARE", &o.maxFolded,
           "of the inside that may be folded; more is warned of")
      .range(0, 1)
      .was("--max-folded");
  c.option("--warn-outside", "SHARE", &o.maxOutside,
           "of the inside that may land outside the target; more is warned of")
      .range(0, 1)
      .was("--max-outside");
  if (frames) return;
  c.option("--warn-crossings", "N", &o.maxCrossings,
           "pairs of the target's triangles that may pass through each other; more is warned of")
      .range(0, 1e15)
      .was("--max-crossings");
}

void judgeMap(const MappedSolid& mapped, const SolidGrids* grids, const VerdictOptions& options,
              MapOrigin origin, Context& context) {
  const bool toTolerance = fitFacts(mapped.facts).tolerance.has_value();
  const std::string advice = foldAdvice(origin, toTolerance, context);
  judgeBoundary(mapped, origin, context);
  const Injectivity& known = grids ? grids->injectivity : mapped.injectivity;
  if (grids || known.inside.checked > 0) {
    const bool mirrors = grids && grids->values.foldedVoxels == grids->values.interiorVoxels;
    // The map itself, not what repair made of its grids.
    const double voxels = grids && !mirrors ? static_cast<double>(grids->values.foldedVoxels) /
                                                  static_cast<double>(grids->values.interiorVoxels)
                                            : 0;
    const double folded = std::max(foldedOf(known), voxels);
    std::string text = foldStatement(folded, known.inside, options.maxFolded);
    if (known.repaired > 0)
      text += fmt::format("; in the grids {} voxels were repaired", known.repaired);
    context.judge(finding("folds", text, folded, options.maxFolded, advice));
    judgeOutside(grids ? std::max(grids->outsideFraction, known.outside) : known.outside, options,
                 advice, context);
  }
  judgeCrossings(mapped, options, context);
}

void judgeFrames(const std::vector<JudgedFrame>& frames, double tolerance,
                 const VerdictOptions& options, Context& context) {
  if (frames.empty()) return;
  const auto worst = [&](auto of) {
    return *std::max_element(frames.begin(), frames.end(),
                             [&](const auto& a, const auto& b) { return of(a) < of(b); });
  };
  std::vector<std::int64_t> missed;
  for (const JudgedFrame& f : frames)
    if (f.misses(tolerance)) missed.push_back(f.number);
  context.report().add("frames", judgedFigures(tolerance, missed));
  const JudgedFrame off = worst([](const JudgedFrame& f) { return f.p99; });
  std::string text = fmt::format(
      "99% of the boundary is within {:.2e} of the diagonal in all {} frames (wanted: {:g})",
      off.p99, frames.size(), tolerance);
  if (!missed.empty())
    text = fmt::format(
        "{} of {} frames miss the tolerance of {:g} at 99% of the boundary: {}; the worst is {}, "
        "with {:.2e}",
        missed.size(), frames.size(), tolerance, listOf(missed), off.number, off.p99);
  context.judge(finding("boundary", text, off.p99, tolerance,
                        "more --charges, another --distance, or a larger --tolerance"));
  const std::string advice = "more --charges; map these frames by `innermap map --one-to-one on`";
  const JudgedFrame folded = worst([](const JudgedFrame& f) { return f.folded; });
  text = folded.folded > 0 ? fmt::format(
                                 "up to {} of the inside is folded, in frame {} (at most: {}): not "
                                 "one-to-one there",
                                 percent(folded.folded), folded.number, percent(options.maxFolded))
                           : "nowhere folded inside, in no frame: one-to-one as far as checked";
  context.judge(finding("folds", text, folded.folded, options.maxFolded, advice));
  const JudgedFrame out = worst([](const JudgedFrame& f) { return f.outside; });
  context.report().add("", outsideFigures(out.outside));
  text = fmt::format(
      "up to {} of the inside lands outside the frame's solid, by more than the "
      "boundary's error{} (at most: {})",
      percent(out.outside),
      out.outside > 0 ? fmt::format(", in frame {}", out.number) : std::string(),
      percent(options.maxOutside));
  context.judge(finding("outside", text, out.outside, options.maxOutside, advice));
}

void judgeTexture(const BoundaryError& error, double tolerance, Context& context) {
  if (error.samples == 0) return;
  context.judge(finding(
      "boundary",
      fmt::format("99% of the surface has its values within {:.2e} (wanted: {:g}, of values in 0 "
                  "to 1)",
                  error.p99, tolerance),
      error.p99, tolerance,
      "more --charges; across seams, where values jump, --seams blend; or a larger --tolerance"));
}

void addCarryVerdictOptions(Command& c, CarryVerdictOptions& o) {
  c.option("--warn-density", "TIMES", &o.maxDensity,
           "that densities may grow, beyond what the solids' volumes explain; more is warned of")
      .above(0)
      .was("--max-density");
  c.option("--warn-lost", "SHARE", &o.maxLost,
           "of the inside where the output's voxels may be over 1.5 times as coarse as what comes "
           "there; more is warned of")
      .range(0, 1)
      .was("--max-lost");
}

void judgeDensity(const JudgedDensity& d, const CarryVerdictOptions& options, Context& context) {
  // Three layers of a fold lie on one another, each as dense as the whole is; what is crushed is
  // denser.
  constexpr double kLayers = 3;
  const double usual = 1 / d.volumes, times = d.growth / usual;
  std::string text =
      fmt::format("the density {} grows up to {:.3g} times {}", d.grid, d.growth, d.where);
  text +=
      fmt::format("(the solids' volumes explain {:.3g}, a fold three times that; at most: {:.3g})",
                  usual, options.maxDensity * usual);
  context.judge(finding("density", text, times, options.maxDensity,
                        fmt::format("--density-limit {:.3g}, which leaves out what comes together "
                                    "beyond that and says how much; or a map that is one-to-one",
                                    kLayers * usual)));
}

void judgeResampling(const ResamplingFigures& f, const CarryVerdictOptions& options,
                     Context& context) {
  if (!(f.sum > 0)) return;
  context.report().add("resampling", figures(f));
  context.judge(finding(
      "resampling",
      fmt::format("in {} of the inside the voxels, of {:.4g}, are over {:g} times as coarse "
                  "as the input's, of {:.4g}, come there (at most: {})",
                  percent(f.coarserShare), f.outputVoxel, kCoarser, f.inputVoxel,
                  percent(options.maxLost)),
      f.coarserShare, options.maxLost,
      fmt::format("--voxel-size {:.3g} or less: finer detail is lost", f.outputVoxel / 2)));
}

}  // namespace innermap::tool
