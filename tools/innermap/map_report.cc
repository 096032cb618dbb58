#include "map_report.h"

#include <fmt/format.h>

#include "innermap/mesh/check.h"
#include "report/figures.h"
#include "report/page/contents.h"

namespace innermap::tool {
namespace {

ReportMesh reportOf(const Mesh& mesh, const MeshReport& check, std::vector<Box3> caps,
                    double volume) {
  ReportMesh out = innermap::tool::reportOf(mesh, volume);
  out.boundaryLoops = static_cast<int>(check.boundaryLoops.size());
  out.caps = static_cast<int>(caps.size());
  out.capPlaces = std::move(caps);
  out.genus = check.genus;
  out.selfIntersections = check.selfIntersections;
  return out;
}

void fillSource(const SourceBoundary& source, Report& report) {
  report.add("source", figures(reportOf(source.mesh, source.check,
                                        capBoxes(source.solid.repaired()), source.solid.volume())));
}

ReportMesh targetOf(const BoundaryPair& pair) {
  return reportOf(pair.targetMesh, pair.targetCheck,
                  capBoxes(pair.solid().repaired(), pair.target.moved), pair.target.volume);
}

void reportSteps(const MapFit& fit, OneToOne wanted, Context& context) {
  const InsideFigures& inside = fit.inside;
  if (inside.samples == 0) return;
  context.report().add("inside", figures(inside));
  context.report().add("steps", stepFigures(fit.steps));
  if (wanted != OneToOne::on || inside.folded == 0) return;
  const Vec3& p = inside.foldedAt.front();
  context.failAfterwards(fmt::format(
      "--one-to-one on is not met: {:.2g}% of the inside is folded, first near ({:.4g}, {:.4g}, "
      "{:.4g}); the report has more places; use more --max-steps",
      100 * inside.folded, p.x, p.y, p.z));
}

void reportTolerance(const MapFit& fit, const FitMapSettings& settings, bool bestEffort,
                     Context& context) {
  const ToleranceOutcome& tolerance = *fit.tolerance;
  const std::string why = whyEnded(tolerance.end, settings.maxSources);
  context.report().add("tolerance", toleranceFigures(&fit, why));
  context.used("--tolerance", tolerance.wanted);
  if (tolerance.met) return;
  const std::string text = fmt::format(
      "--tolerance {:g} is not met: 99% of the boundary lies within {:.3g} of the target's "
      "diagonal, with {} charges; {}; {:.2g}% of the boundary misses it, most near ({:.4g}, "
      "{:.4g}, "
      "{:.4g})",
      tolerance.wanted, tolerance.reached, fit.solve.sources, why, 100 * fit.error.missed,
      fit.error.maxAt.x, fit.error.maxAt.y, fit.error.maxAt.z);
  if (bestEffort)
    context.warning(text);
  else
    context.failAfterwards(text + "; the files say so (--best-effort: exit code 0)");
}

}  // namespace

std::string whyEnded(AdaptiveEnd end, std::size_t maxSources) {
  switch (end) {
    case AdaptiveEnd::maxSources:
      return fmt::format("--max-charges {} is reached", maxSources);
    case AdaptiveEnd::maxMemory:
      return "--max-memory is reached";
    case AdaptiveEnd::jumps:
      return "it holds except where parts cross and slide along each other";
    case AdaptiveEnd::noGain:
      return "more charges do not help";
    case AdaptiveEnd::time:
      return "--max-time is reached";
    case AdaptiveEnd::met:
    case AdaptiveEnd::stopped:
      break;
  }
  return "--interpolation smooth fits the vertices alone";
}

ReportMesh reportOf(const Mesh& mesh, double volume) {
  ReportMesh out;
  out.path = mesh.name;
  out.vertices = mesh.vertices.size();
  out.triangles = mesh.triangles.size();
  out.volume = volume;
  out.diagonal = boundingBox(mesh).diagonal();
  return out;
}

void reportSolid(const Mesh& mesh, const Solid& solid, Report& report) {
  ReportMesh source = reportOf(mesh, solid.volume());
  source.caps = source.boundaryLoops = solid.repaired().caps;
  source.capPlaces = capBoxes(solid.repaired());
  report.add("source", figures(source));
}

void reportSource(const SourceBoundary& source, Context& context) {
  context.tell(source);
  fillSource(source, context.report());
}

void reportBoundaries(const BoundaryPair& pair, Context& context) {
  context.tell(pair);
  fillSource(pair.source, context.report());
  context.report().add("target", figures(targetOf(pair)));
}

void reportLaid(const BoundaryPair& pair, const std::string& path, Context& context) {
  context.tell(pair);
  ReportMesh laid = targetOf(pair);
  laid.path = path;
  context.report().add("laid", figures(laid));
}

void reportFit(const MapFit& fit, const FitMapSettings& settings, bool bestEffort,
               Context& context) {
  context.tell(fit);
  if (context.page()) showMap(*context.page(), fit);
  Report& report = context.report();
  if (fit.tolerance) reportTolerance(fit, settings, bestEffort, context);
  reportSteps(fit, settings.oneToOne, context);
  report.add("solve", figures(fit.solve));
  report.add("solve", choiceFigures(settings.seed, fit.smooth));
  report.add("boundary_error", boundaryErrorFigures(&fit));
  const BoundaryError& e = fit.error;
  context.detail(fmt::format("boundary error: rms {:.2e}, 99% {:.2e}, max {:.2e} of the diagonal\n",
                             e.rms, e.p99, e.max));
}

void reportFitter(const FrameFitter& fitter, const FrameFitterSettings& settings, Report& report) {
  MapSolve solve;
  solve.method = SolveMethod::iterative;
  solve.placement = MapPlacement::shell;
  solve.sources = solve.rank = fitter.sources().size();
  solve.collocation = fitter.collocation();
  solve.distance = fitter.distance();
  Figures of = only(figures(solve), {"method", "sources", "collocation", "rank", "regularization",
                                     "iterations", "placement", "distance"});
  if (!fitter.iterative()) of.front().value = std::string("dense");
  report.add("solve", of);
  report.add("solve", choiceFigures(settings.seed));
}

void reportInjectivity(const Injectivity& known, Context& context) {
  context.report().add("one_to_one", figures(known));
  context.detail(injectivityLine(known) + "\n");
}

void reportGrids(const SolidGrids& grids, const LameConstants& lame, Context& context) {
  context.tell(grids);
  Report& report = context.report();
  const MapGrids& values = grids.values;
  report.add("energy", energyFigures(values));
  report.add("energy", figures(lame));
  report.add("jacobian", jacobianFigures(values));
  report.add("grid", gridFigures(grids));
  if (values.repaired) report.add("repair", repairFigures(values));
  context.detail(fmt::format(
      "energy: harmonic {:.6g}, deformation {:.6g}\n"
      "jacobian: {:.4g} to {:.4g}, folded {:.3g}% of the volume\n"
      "grid: {} active voxels of {:.6g}\n",
      values.harmonicTotal, values.deformationTotal, values.jacobianMin, values.jacobianMax,
      100 * values.foldedFraction, values.activeVoxels, grids.voxelSize));
  reportInjectivity(grids.injectivity, context);
}

}  // namespace innermap::tool
