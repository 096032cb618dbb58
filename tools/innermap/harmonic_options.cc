#include "harmonic_options.h"

#include <fmt/format.h>

#include "fitting_options.h"
#include "innermap/core/memory.h"
#include "innermap/fit/fit_harmonic.h"
#include "innermap/fit/fit_map.h"
#include "inputs.h"
#include "job_cost.h"
#include "jobs/harmonic_job.h"
#include "lists.h"
#include "map_report.h"
#include "report/figures.h"

namespace innermap::tool {
namespace {

void reportHarmonic(const HarmonicFit& fit, const HarmonicOptions& options, Context& context) {
  context.tell(fit);
  Report& report = context.report();
  const BoundaryError& e = fit.error;
  report.add("solve", solveFigures(fit));
  report.add("solve", choiceFigures(options.fit.seed));
  report.add("boundary_error", boundaryErrorFigures(fit));
  report.add("tolerance", toleranceFigures(fit, options.fit.tolerance));
  report.add("field", fieldFigures(fit.span, fit.freeShare));
  context.print(fmt::format(
      "boundary error: rms {:.2e}, 99% {:.2e}, max {:.2e} of the values' span of {:.4g}; inside at "
      "most {:.2e}\n",
      e.rms, e.p99, e.max, fit.span, fit.bound));
  if (fit.met) return;
  const std::string text = fmt::format(
      "--tolerance {:g} is not met: 99% of the boundary lies within {:.3g} of the values' span, "
      "with "
      "{} charges; {}",
      options.fit.tolerance, e.p99, fit.sources, whyEnded(fit.end, options.fit.maxSources));
  if (options.bestEffort)
    context.warning(text);
  else
    context.failAfterwards(text + "; the files say so (--best-effort: exit code 0)");
}

HarmonicGridSettings gridSettingsOf(const HarmonicOptions& options) {
  auto out = options.grid.in<HarmonicGridSettings>();
  out.values = out.gradients = out.directions = out.magnitudes = false;
  for (const std::string& name : commaList(options.grids)) {
    if (name == "value")
      out.values = true;
    else if (name == "gradient")
      out.gradients = true;
    else if (name == "direction")
      out.directions = true;
    else if (name == "magnitude")
      out.magnitudes = true;
    else
      throw UsageError("--grids: '" + name +
                       "' is not one of value, gradient, direction, magnitude");
  }
  return out;
}

}  // namespace

void addHarmonicOptions(Command& command, HarmonicOptions& o, const std::string& defaultGrids) {
  o.grids = defaultGrids;
  command.positional("MESH", &o.mesh, "mesh of the solid: .obj, .ply, .off or .stl");
  command.outputFile(&o.output, {".vdb"}, "the grids, a .vdb file");
  command
      .option("--field", "FILE", &o.field,
              "also write the field in double precision, a .ply file of charges and weights")
      .writes({".ply"});
  command.limitTime("stop adding charges after this time");
  command.settings(describe(o.fit));
  command.setting(creaseSetting(&o.creaseAngle));
  command.flag("--best-effort", &o.bestEffort, "only warn if the tolerance is not met");
  command.settings(describe(o.grid));
  command.option(
      "--grids", "LIST", &o.grids,
      "what to write for each channel, of value, gradient, direction (unit vectors) and magnitude");
  command.setting(namesSetting(&o.names));
}

void runHarmonic(const HarmonicOptions& options,
                 const std::function<NamedConditions(const Mesh& mesh)>& conditionsOf,
                 Context& context) {
  const HarmonicGridSettings grids = gridSettingsOf(options);
  context.output(options.output);
  if (!options.field.empty()) context.output(options.field);
  Mesh mesh = readMeshFile(options.mesh, context);
  NamedConditions known = conditionsOf(mesh);
  const std::size_t vertices = mesh.vertices.size();
  const HarmonicJob job =
      harmonicJob(std::move(mesh), std::move(known.conditions), options.creaseAngle);
  const Solid& solid = job.boundary.solid;
  reportSource(job.boundary, context);
  FitMapSettings like;
  like.tolerance = options.fit.tolerance;
  like.oneToOne = OneToOne::off;
  like.prove = Prove::off;
  requireInterior(solid, options.grid.in<LevelSetSettings>());
  JobSize size = jobSize(solid, grids);
  size.items = static_cast<double>(known.names.size()) * size.inside;
  std::vector<JobPhase> phases = fittingPhases(like, likelyPlaces(vertices, like.tolerance), false);
  for (JobPhase& phase : phases) phase *= 1 + 0.1 * static_cast<double>(known.names.size());
  for (const char* stage : {"level set", "evaluating the field", "writing the VDB file"})
    phases.push_back(stageOf(stage, size));
  context.expect(phases);
  if (!context.begins(
          {fmt::format("fit {} channel(s) on {}", known.names.size(), options.mesh),
           "write grids to " + options.output},
          {harmonicNeed(vertices), fieldGridNeed(solid, known.names.size(), options.grid, grids)}))
    return;
  context.spend(Context::kMostOfTime);
  const HarmonicFit fit = job.fit(options.fit);
  reportHarmonic(fit, options, context);
  const Facts facts = harmonicFacts(fit, options.fit, options.mesh, known.names);
  HarmonicGridSettings evaluation = grids;
  evaluation.span = fit.span;
  const HarmonicGrids made = evaluateHarmonic(fit.field, solid, known.names, evaluation);
  for (const std::string& text : made.warnings) context.warning(text);
  addSeconds(context.report().seconds, made.seconds);
  context.report().add("grid", gridFigures(made.voxelSize, made.activeVoxels, made.interiorVoxels));
  describeField(made.all(), facts);
  writeGridFile(options.output, made.all(), options.names, context);
  if (!options.field.empty())
    context.timed("write", [&] {
      writeSolidField(options.field, {fit.field, job.boundary, known.names, facts});
    });
}

}  // namespace innermap::tool
