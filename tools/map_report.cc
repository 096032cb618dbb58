#include "map_report.h"

#include <fmt/format.h>

#include <algorithm>

#include "html/contents.h"
#include "innermap/mesh/cap_boxes.h"

namespace innermap::tool {
namespace {

ReportMesh reportOf(const Mesh& mesh, const MeshReport& check, int caps, double volume) {
  ReportMesh out = innermap::tool::reportOf(mesh, volume);
  out.boundaryLoops = static_cast<int>(check.boundaryLoops.size());
  out.caps = caps;
  out.genus = check.genus;
  return out;
}

void fillSource(const SourceBoundary& source, Report& report) {
  report.source =
      reportOf(source.mesh, source.check, source.solid.repaired().caps, source.solid.volume());
  reportCaps("source", capBoxes(source.solid.repaired()), report);
  report.set("source.self_intersections", source.check.selfIntersections);
}

void reportAdaptive(const MapSolve& solve, Report& report) {
  const auto& levels = solve.levels;
  const auto& rounds = solve.rounds;
  report.setColumn("solve.level_distances", levels, [](const auto& l) { return l.distance; });
  report.setColumn("solve.level_sources", levels, [](const auto& l) { return l.sources; });
  report.setColumn("solve.round_sources", rounds, [](const auto& r) { return r.sources; });
  report.setColumn("solve.round_p99", rounds, [](const auto& r) { return r.error.p99; });
}

void reportSolve(const MapSolve& solve, Report& report) {
  report.solve = ReportSolve{wordOf(solve.method), solve.sources,        solve.collocation,
                             solve.rank,           solve.regularization, solve.iterations};
  report.set("solve.placement", wordOf(solve.placement));
  if (solve.radiusRatio > 0)
    report.set("solve.radius_ratio", solve.radiusRatio);
  else if (solve.distance > 0)
    report.set("solve.distance", solve.distance);
  const bool adaptive = !solve.levels.empty();
  if (adaptive) reportAdaptive(solve, report);
  if (adaptive || solve.method == SolveMethod::iterative) {
    report.set("solve.residuals", solve.residuals);
    report.set("solve.product_error", solve.productError);
  } else
    report.set("solve.condition", solve.condition);
  report.set("solve.weight_norm", solve.weightNorm);
  if (!adaptive) report.set("solve.held_out", solve.heldOut);
  if (solve.trials.empty()) return;
  report.setColumn("solve.tried_distances", solve.trials, [](auto& t) { return t.distance; });
  report.setColumn("solve.tried_errors", solve.trials, [](auto& t) { return t.heldOutRms; });
}

std::vector<double> coordinates(const Points& points) {
  std::vector<double> out;
  for (const Vec3& p : points) out.insert(out.end(), {p.x, p.y, p.z});
  return out;
}

void reportSteps(const MapFit& fit, OneToOne wanted, Context& context) {
  const InsideFigures& inside = fit.inside;
  if (inside.samples == 0) return;
  Report& report = context.report();
  report.set("inside.samples", inside.samples);
  report.set("inside.folded", inside.folded);
  report.set("inside.folded_at_overlap", static_cast<double>(inside.determinants.foldedAtOverlap) /
                                             static_cast<double>(inside.samples));
  report.set("inside.outside", inside.outside);
  report.set("inside.folded_at", coordinates(inside.foldedAt));
  const auto& steps = fit.steps;
  report.set("steps.count", std::max<std::size_t>(1, steps.size()));
  if (!steps.empty()) {
    report.setColumn("steps.to", steps, [](const MapStep& s) { return s.to; });
    report.setColumn("steps.sources", steps, [](const MapStep& s) { return s.sources; });
    report.setColumn("steps.p99", steps, [](const MapStep& s) { return s.error; });
    report.setColumn("steps.folded", steps, [](const MapStep& s) { return s.folded; });
  }
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
  Report& report = context.report();
  report.set("tolerance.wanted", tolerance.wanted);
  context.used("--tolerance", tolerance.wanted);
  report.set("tolerance.reached", tolerance.reached);
  report.set("tolerance.met", tolerance.met);
  if (tolerance.met) return;
  const std::string why = whyEnded(tolerance.end, settings.maxSources);
  report.set("tolerance.ended", why);
  report.set("tolerance.missed", fit.error.missed);
  report.set("tolerance.worst_at", coordinates({fit.error.maxAt}));
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
    context.failAfterwards(text + "; what is written is marked so (--best-effort: exit code 0)");
}

}  // namespace

std::string whyEnded(AdaptiveEnd end, std::size_t maxSources) {
  switch (end) {
    case AdaptiveEnd::maxSources:
      return fmt::format("--max-charges {} is reached", maxSources);
    case AdaptiveEnd::maxMemory:
      return "--max-memory is reached";
    case AdaptiveEnd::jumps:
      return "it holds but where parts that cross slide along each other";
    case AdaptiveEnd::noGain:
      return "more charges do not help";
    case AdaptiveEnd::time:
      return "--max-time is reached";
    case AdaptiveEnd::met:
    case AdaptiveEnd::stopped:
      break;
  }
  return "vertices are all that --interpolation smooth fits";
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

void reportCaps(const std::string& key, const std::vector<Box3>& caps, Report& report) {
  if (caps.empty()) return;
  report.setColumn(key + ".cap_places.x", caps, [](auto& c) { return c.center().x; });
  report.setColumn(key + ".cap_places.y", caps, [](auto& c) { return c.center().y; });
  report.setColumn(key + ".cap_places.z", caps, [](auto& c) { return c.center().z; });
  report.setColumn(key + ".cap_places.size", caps, [](auto& c) { return c.diagonal(); });
}

void reportSolid(const Mesh& mesh, const Solid& solid, Report& report) {
  report.source = reportOf(mesh, solid.volume());
  report.source->caps = report.source->boundaryLoops = solid.repaired().caps;
  reportCaps("source", capBoxes(solid.repaired()), report);
}

void reportSource(const SourceBoundary& source, Context& context) {
  context.tell(source);
  fillSource(source, context.report());
}

void reportBoundaries(const BoundaryPair& pair, Context& context) {
  context.tell(pair);
  Report& report = context.report();
  fillSource(pair.source, report);
  report.target =
      reportOf(pair.targetMesh, pair.targetCheck, pair.solid().repaired().caps, pair.target.volume);
  reportCaps("target", capBoxes(pair.solid().repaired(), pair.target.moved), report);
  report.set("target.self_intersections", pair.targetCheck.selfIntersections);
}

void reportFit(const MapFit& fit, const FitMapSettings& settings, bool bestEffort,
               Context& context) {
  context.tell(fit);
  if (context.page()) showMap(*context.page(), fit);
  Report& report = context.report();
  if (fit.verticesRms) report.set("boundary_error.vertices_rms", *fit.verticesRms);
  if (fit.tolerance) reportTolerance(fit, settings, bestEffort, context);
  reportSteps(fit, settings.oneToOne, context);
  reportSolve(fit.solve, report);
  report.set("solve.interpolation", fit.smooth ? "smooth" : "linear");
  report.set("solve.seed", settings.seed);
  const BoundaryError& e = fit.error;
  report.set("boundary_error.p99_bound", e.p99Bound);
  report.set("boundary_error.bound", e.bound);
  report.set("boundary_error.confidence", kCertificateConfidence);
  report.set("boundary_error.searched", e.searched);
  if (fit.verticesMax) report.set("boundary_error.vertices_max", *fit.verticesMax);
  if (fit.triangles) report.set("boundary_error.triangles", *fit.triangles);
  report.set("boundary_error.smooth_bound", fit.smoothBound);
  report.boundaryError = ReportBoundaryError{e.rms, e.p99, e.max, e.samples, fit.collocationError};
  context.print(fmt::format("boundary error: rms {:.2e}, 99% {:.2e}, max {:.2e} of the diagonal\n",
                            e.rms, e.p99, e.max));
}

void reportFitter(const FrameFitter& fitter, const FrameFitterSettings& settings, Report& report) {
  const std::size_t sources = fitter.sources().size();
  report.solve = ReportSolve{fitter.iterative() ? wordOf(SolveMethod::iterative) : "dense", sources,
                             fitter.collocation(), sources};
  report.set("solve.placement", wordOf(MapPlacement::shell));
  report.set("solve.distance", fitter.distance());
  report.set("solve.seed", settings.seed);
}

void reportInjectivity(const Injectivity& known, Context& context) {
  Report& report = context.report();
  report.set("one_to_one.statement", injectivityStatement(known));
  for (const auto& [name, value] : injectivityFigures(known))
    std::visit([&, key = "one_to_one." + name](auto v) { report.set(key, v); }, value);
  report.set("one_to_one.source_crossings_at", coordinates(known.source.places));
  report.set("one_to_one.target_crossings_at", coordinates(known.target.places));
  context.print(injectivityLine(known) + "\n");
}

void reportGrids(const SolidGrids& grids, const LameConstants& lame, Context& context) {
  context.tell(grids);
  Report& report = context.report();
  const MapGrids& values = grids.values;
  report.energy = ReportEnergy{values.harmonicTotal, values.deformationTotal};
  report.set("energy.deformation_mean",
             values.volume > 0 ? values.deformationTotal / values.volume : 0.0);
  report.set("energy.lame_lambda", lame.lambda);
  report.set("energy.lame_mu", lame.mu);
  report.jacobian = ReportJacobian{values.jacobianMin, values.jacobianMax, values.foldedFraction};
  report.grid = ReportGrid{grids.voxelSize, values.activeVoxels, values.interiorVoxels};
  report.set("grid.volume", values.volume);
  report.set("grid.map_rounding", grids.mapRounding);
  if (grids.mapLocal)
    report.set("grid.map_local_origin",
               std::vector<double>{grids.localOrigin.x, grids.localOrigin.y, grids.localOrigin.z});
  if (values.repaired) {
    report.set("repair.folded_voxels", values.foldedVoxels);
    report.set("repair.left", values.foldedVoxelsLeft);
    report.set("repair.farthest", values.repairedFarthest);
  }
  context.print(fmt::format(
      "energy: harmonic {:.6g}, deformation {:.6g}\n"
      "jacobian: {:.4g} to {:.4g}, folded {:.3g}% of the volume\n"
      "grid: {} active voxels of {:.6g}\n",
      values.harmonicTotal, values.deformationTotal, values.jacobianMin, values.jacobianMax,
      100 * values.foldedFraction, values.activeVoxels, grids.voxelSize));
  reportInjectivity(grids.injectivity, context);
}

}  // namespace innermap::tool
