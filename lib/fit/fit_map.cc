#include "innermap/fit/fit_map.h"

#include <fmt/format.h>

#include <algorithm>

#include "fit/detail/map_fitter.h"
#include "innermap/core/version.h"
#include "innermap/field/field_file.h"

namespace innermap {
namespace {

Facts factsOf(const BoundaryPair& pair, const FitOutcome& out, std::uint64_t seed) {
  const auto oneLine = [](std::string text) {
    std::replace_if(
        text.begin(), text.end(), [](char c) { return c == '\n' || c == '\r'; }, '_');
    return text;
  };
  Facts facts{{"version", versionText()},
              {"source", oneLine(pair.source.mesh.name)},
              {"target", oneLine(pair.targetMesh.name)},
              {"method", wordOf(out.solve.method)},
              {"interpolation", out.smooth ? "smooth" : "linear"},
              {"seed", std::to_string(seed)},
              {"regularization", textOfFact(out.solve.regularization)},
              {"rank", std::to_string(out.solve.rank)}};
  const auto add = [&](const Facts& more) { facts.insert(facts.end(), more.begin(), more.end()); };
  add(factsOf(out.error));
  add({{"boundary_error_p99_bound", textOfFact(out.error.p99Bound)},
       {"boundary_error_bound", textOfFact(out.error.bound)},
       {"boundary_error_confidence", textOfFact(kCertificateConfidence)},
       {"boundary_error_smooth_bound", textOfFact(out.certificate.smoothBound)},
       {"c_error", textOfFact(out.collocationError)}});
  if (out.solve.radiusRatio > 0)
    facts.emplace_back("radius_ratio", textOfFact(out.solve.radiusRatio));
  else
    facts.emplace_back("distance", textOfFact(out.solve.distance));
  if (out.smooth)
    facts.emplace_back("boundary_error_vertices_max", textOfFact(out.certificate.verticesMax));
  else
    facts.emplace_back("boundary_error_triangles", textOfFact(out.certificate.triangles));
  if (!out.steps.empty()) facts.emplace_back("steps", std::to_string(out.steps.size()));
  if (out.inside.samples > 0) facts.emplace_back("folded", textOfFact(out.inside.folded));
  if (const auto& t = out.tolerance) add(factsOfTolerance(t->wanted, t->reached, t->met));
  return facts;
}

void noteSteps(MapFit& fit, double singleFolded, std::size_t singleSources) {
  if (fit.steps.empty()) return;
  fit.notes.push_back(
      fmt::format("one harmonic map, of {} charges, folds {:.2g}% of the inside; in {} steps "
                  "{:.2g}% folds and {:.2g}% lands outside the target",
                  singleSources, 100 * singleFolded, fit.steps.size(), 100 * fit.inside.folded,
                  100 * fit.inside.outside));
}

void noteJumps(MapFit& fit, const std::vector<ValueJump>& jumps) {
  const std::string text = jumpsText(jumps, fit.boundary.target.diagonal, "the target's diagonal");
  if (!text.empty()) fit.notes.push_back(fit.boundary.source.mesh.name + ": " + text);
}

void noteProducts(MapFit& fit) {
  if (fit.solve.productError > 0)
    fit.notes.push_back(
        fmt::format("the charges nearly cancel: their sums were exact to {:.1g} of the values, "
                    "about as well as rounding allows; use more collocation points a charge",
                    fit.solve.productError));
}

void warnOfError(MapFit& fit) {
  if (fit.error.max > kDoubtfulError)
    fit.warnings.push_back(fmt::format(
        "the boundary error reaches {:.2g} of the diagonal: do not trust this map; use {}",
        fit.error.max, fit.tolerance ? "a smaller tolerance" : "more charges"));
}

}  // namespace

std::uint64_t fitMapMemory(const FitMapSettings& settings, std::size_t vertices) {
  // Measured, bytes: the certificate and the look at the inside, of a vertex and at least.
  constexpr std::uint64_t kVertex = 2100, kChecks = 40'000'000;
  PointCounts counts = kFirstCounts;
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
  requireInRange(settings);
  MapFitter fitter(boundary, settings);
  FitOutcome out =
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
  noteJumps(fit, fitter.jumps);
  noteProducts(fit);
  noteSteps(fit, fitter.singleFolded, fitter.singleSources);
  warnOfError(fit);
  return fit;
}

MapFit fitMap(const Mesh& source, const Mesh& target, const FitMapSettings& settings) {
  MapFit fit = fitMap(makeBoundaryPair(source, target), settings);
  fit.notes.insert(fit.notes.begin(), fit.boundary.notes.begin(), fit.boundary.notes.end());
  fit.warnings.insert(fit.warnings.begin(), fit.boundary.warnings.begin(),
                      fit.boundary.warnings.end());
  StageSeconds seconds = fit.boundary.seconds;
  addSeconds(seconds, fit.seconds);
  fit.seconds = std::move(seconds);
  return fit;
}

}  // namespace innermap
