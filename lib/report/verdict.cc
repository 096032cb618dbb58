#include "report/verdict.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "innermap/field/field_file.h"
#include "report/figures.h"
#include "report/report_figures.h"

namespace innermap {
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

void add(Verdict& out, const std::string& section, Figures figures) {
  out.figures.emplace_back(section, std::move(figures));
}

std::string boundaryAdvice(MapOrigin origin, bool toTolerance) {
  if (origin == MapOrigin::file)
    return "fit the map again with a smaller --tolerance, or more --charges";
  return toTolerance ? "more --max-charges or --max-memory, a finer or smoother mesh, or a larger "
                       "--tolerance"
                     : "--tolerance in place of a number of charges, or more --charges";
}

std::string foldAdvice(const MappedSolid& mapped, MapOrigin origin, const FitMapSettings& fitted) {
  const std::string laid = ", pairs of places in --landmarks, or --aligned if both stand alike";
  if (origin == MapOrigin::file)
    return "fit the map again with --one-to-one on, a smaller --tolerance, or for solids that were "
           "never related --landmarks or --aligned";
  if (!fitFacts(mapped.facts).tolerance)
    return "--one-to-one on with --tolerance, in place of a number of charges";
  const bool allSteps = static_cast<int>(mapped.map.steps().size()) >= fitted.maxSteps;
  const bool tried =
      fitted.oneToOne == OneToOne::on || (allSteps && fitted.oneToOne == OneToOne::automatic);
  const std::string first =
      tried ? fmt::format("more --max-steps than {}, a smaller --tolerance", fitted.maxSteps)
            : "--one-to-one on, a smaller --tolerance";
  return origin == MapOrigin::laidOn ? first + laid : first;
}

void judgeBoundary(const MappedSolid& mapped, MapOrigin origin, Verdict& out) {
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
  out.findings.push_back({std::move(f), toTolerance && origin != MapOrigin::file});
}

std::string foldStatement(double folded, const Injectivity& known, double threshold) {
  const DeterminantFigures& points = known.inside;
  if (folded <= 0) return "nowhere folded inside: one-to-one as far as checked";
  std::string out = fmt::format("{} of the inside is folded (at most: {}): turned over there",
                                percent(folded), percent(threshold));
  if (points.foldedAtOverlap > 0)
    out += fmt::format(
        ", {} of that where the target runs through itself",
        percent(static_cast<double>(points.foldedAtOverlap) / static_cast<double>(points.folded)));
  return out;
}

// The target of a source that was laid onto a mesh is its image there, whose flat triangles can
// cross where the mesh itself does not.
void judgeCrossings(const MappedSolid& mapped, const VerdictSettings& settings, MapOrigin origin,
                    Verdict& out) {
  const SelfIntersectionFigures& target = mapped.injectivity.target;
  const SelfIntersectionFigures& source = mapped.injectivity.source;
  const bool laid = origin == MapOrigin::laidOn;
  const char* const what = laid ? "the source, as laid onto the target," : "the target";
  std::string text = target.pairs == 0 ? fmt::format("{} nowhere runs through itself", what)
                                       : fmt::format(
                                             "{} runs through itself: {} pair{} of triangles, "
                                             "where no map is one-to-one",
                                             what, target.pairs, target.pairs == 1 ? "" : "s");
  if (source.pairs > 0) text += fmt::format("; the source does, in {}", source.pairs);
  out.findings.push_back(
      {finding(
           "self_intersections", text, static_cast<double>(target.pairs),
           static_cast<double>(settings.maxCrossings),
           std::string(laid ? "pairs of places in --landmarks, another way by --choose, "
                            : "repair the target where `innermap check` places the crossings, ") +
               "or allow them by --warn-crossings"),
       true});  // reading the boundaries warned of it
}

double foldedOf(const Injectivity& known, const SolidGrids* grids) {
  const auto shareOf = [](std::uint64_t folded, std::uint64_t all) {
    return all == 0 ? 0.0 : static_cast<double>(folded) / static_cast<double>(all);
  };
  const double inside = shareOf(known.inside.folded, known.inside.checked);
  // The map itself, not what repair made of its grids.
  return grids ? std::max(inside, shareOf(grids->values.foldedVoxels, grids->values.interiorVoxels))
               : inside;
}

void judgeOutside(double outside, const VerdictSettings& settings, const std::string& advice,
                  Verdict& out) {
  add(out, "", outsideFigures(outside));
  out.findings.push_back(
      {finding("outside",
               fmt::format("{} of the inside lands outside the target, by more than the "
                           "boundary's error (at most: {})",
                           percent(outside), percent(settings.maxOutside)),
               outside, settings.maxOutside, advice)});
}

std::string listOf(const std::vector<std::int64_t>& numbers) {
  constexpr std::size_t kMost = 12;
  const std::vector<std::int64_t> first(
      numbers.begin(),
      numbers.begin() + static_cast<std::ptrdiff_t>(std::min(kMost, numbers.size())));
  return fmt::format("{}{}", fmt::join(first, ", "), numbers.size() > kMost ? ", ..." : "");
}

}  // namespace

std::vector<Setting> describe(VerdictSettings& s, bool frames) {
  std::vector<Setting> out{
      Setting("warn_folded", "SHARE", &s.maxFolded,
              "warn if more than this share of the inside folds")
          .from(0, 1)
          .was("max_folded"),
      Setting("warn_outside", "SHARE", &s.maxOutside,
              "warn if more than this share of the inside lands outside the target")
          .from(0, 1)
          .was("max_outside")};
  if (!frames)
    out.push_back(
        Setting("warn_crossings", "N", &s.maxCrossings,
                "warn if more than this many pairs of the target's triangles cross each other")
            .from(0, 1e15)
            .was("max_crossings"));
  return out;
}

Verdict judgeMap(const MappedSolid& mapped, const SolidGrids* grids,
                 const VerdictSettings& settings, MapOrigin origin, const FitMapSettings& fitted) {
  Verdict out;
  const std::string advice = foldAdvice(mapped, origin, fitted);
  judgeBoundary(mapped, origin, out);
  const Injectivity& known = grids ? grids->injectivity : mapped.injectivity;
  if (grids || known.inside.checked > 0) {
    const double folded = foldedOf(known, grids);
    std::string text = foldStatement(folded, known, settings.maxFolded);
    if (known.repaired > 0)
      text += fmt::format("; in the grids {} voxels were repaired", known.repaired);
    out.findings.push_back({finding("folds", text, folded, settings.maxFolded, advice)});
    judgeOutside(grids ? std::max(grids->outsideFraction, known.outside) : known.outside, settings,
                 advice, out);
  }
  judgeCrossings(mapped, settings, origin, out);
  return out;
}

JudgedFrame judgedFrame(const NumberedFit& frame) {
  const FrameFit& fit = *frame.fit;
  return {frame.number, fit.error.p99, fit.folded(), fit.injectivity.outside};
}

Verdict judgeFrames(const std::vector<JudgedFrame>& frames, double tolerance,
                    const VerdictSettings& settings) {
  Verdict out;
  if (frames.empty()) return out;
  const auto worst = [&](auto of) {
    return *std::max_element(frames.begin(), frames.end(),
                             [&](const auto& a, const auto& b) { return of(a) < of(b); });
  };
  std::vector<std::int64_t> missed;
  for (const JudgedFrame& f : frames)
    if (f.misses(tolerance)) missed.push_back(f.number);
  add(out, "frames", judgedFigures(tolerance, missed));
  const JudgedFrame off = worst([](const JudgedFrame& f) { return f.p99; });
  std::string text = fmt::format(
      "99% of the boundary is within {:.2e} of the diagonal in all {} frames (wanted: {:g})",
      off.p99, frames.size(), tolerance);
  if (!missed.empty())
    text = fmt::format(
        "{} of {} frames miss the tolerance of {:g} at 99% of the boundary: {}; the worst is {}, "
        "with {:.2e}",
        missed.size(), frames.size(), tolerance, listOf(missed), off.number, off.p99);
  out.findings.push_back({finding("boundary", text, off.p99, tolerance,
                                  "more --charges, another --distance, or a larger --tolerance")});
  const std::string advice = "more --charges; map these frames by `innermap map --one-to-one on`";
  const JudgedFrame folded = worst([](const JudgedFrame& f) { return f.folded; });
  text = folded.folded > 0 ? fmt::format(
                                 "up to {} of the inside is folded, in frame {} (at most: {}): "
                                 "turned over there",
                                 percent(folded.folded), folded.number, percent(settings.maxFolded))
                           : "no frame folds inside: one-to-one as far as checked";
  out.findings.push_back({finding("folds", text, folded.folded, settings.maxFolded, advice)});
  const JudgedFrame outside = worst([](const JudgedFrame& f) { return f.outside; });
  add(out, "", outsideFigures(outside.outside));
  text = fmt::format(
      "up to {} of the inside lands outside the frame's solid, by more than the "
      "boundary's error{} (at most: {})",
      percent(outside.outside),
      outside.outside > 0 ? fmt::format(", in frame {}", outside.number) : std::string(),
      percent(settings.maxOutside));
  out.findings.push_back({finding("outside", text, outside.outside, settings.maxOutside, advice)});
  return out;
}

Verdict judgeTexture(const BoundaryError& error, double tolerance) {
  Verdict out;
  if (error.samples == 0) return out;
  out.findings.push_back({finding(
      "boundary",
      fmt::format("99% of the surface has its values within {:.2e} (wanted: {:g}, of values in 0 "
                  "to 1)",
                  error.p99, tolerance),
      error.p99, tolerance,
      "more --charges; across seams, where values jump, --seams blend; or a larger --tolerance")});
  return out;
}

std::vector<Setting> describe(CarryVerdictSettings& s) {
  return {
      Setting("warn_density", "TIMES", &s.maxDensity,
              "warn if densities grow more than this, beyond what the solids' volumes explain")
          .above(0)
          .was("max_density"),
      Setting("warn_lost", "SHARE", &s.maxLost,
              "warn if, in more than this share of the inside, the output's voxels are over 1.5 "
              "times as coarse as the input's")
          .from(0, 1)
          .was("max_lost")};
}

Verdict judgeDensity(const JudgedDensity& d, const CarryVerdictSettings& settings) {
  Verdict out;
  // Three layers of a fold lie on one another, each as dense as the whole is; what is crushed is
  // denser.
  constexpr double kLayers = 3;
  const double usual = 1 / d.volumes, times = d.growth / usual;
  std::string text =
      fmt::format("the density {} grows up to {:.3g} times {}", d.grid, d.growth, d.where);
  text +=
      fmt::format("(the solids' volumes explain {:.3g}, a fold three times that; at most: {:.3g})",
                  usual, settings.maxDensity * usual);
  out.findings.push_back(
      {finding("density", text, times, settings.maxDensity,
               fmt::format("--density-limit {:.3g}, which leaves out the mass beyond that and says "
                           "how much; or a map that is one-to-one",
                           kLayers * usual))});
  return out;
}

Verdict judgeResampling(const ResamplingFigures& f, const CarryVerdictSettings& settings) {
  Verdict out;
  if (!(f.sum > 0)) return out;
  add(out, "resampling", figures(f));
  out.findings.push_back({finding(
      "resampling",
      fmt::format("in {} of the inside the output's voxels ({:.4g}) are over {:g} times as coarse "
                  "as the input's ({:.4g}) after the map (at most: {})",
                  percent(f.coarserShare), f.outputVoxel, kCoarser, f.inputVoxel,
                  percent(settings.maxLost)),
      f.coarserShare, settings.maxLost,
      fmt::format("--voxel-size {:.3g} or less: finer detail is lost", f.outputVoxel / 2))});
  return out;
}

}  // namespace innermap
