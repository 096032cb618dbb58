#include "harmonic_options.h"

#include <fmt/format.h>

#include <algorithm>

#include "innermap/boundary/fit_map.h"
#include "innermap/core/memory.h"
#include "innermap/core/version.h"
#include "innermap/field/field_file.h"
#include "inputs.h"
#include "lists.h"
#include "map_report.h"

namespace innermap::tool {
namespace {

std::string why(AdaptiveEnd end, const HarmonicFitSettings& settings) {
  if (end == AdaptiveEnd::maxSources)
    return fmt::format("--max-sources {} is reached", settings.maxSources);
  return end == AdaptiveEnd::maxMemory ? "--max-memory is reached" : "more charges do not help";
}

void reportHarmonic(const HarmonicFit& fit, const HarmonicOptions& options, Context& context) {
  context.tell(fit);
  Report& report = context.report();
  const BoundaryError& e = fit.error;
  report.solve = ReportSolve{"adaptive", fit.sources, fit.collocation, fit.sources, 0, 0};
  report.set("solve.seed", options.fit.seed);
  report.boundaryError = ReportBoundaryError{e.rms, e.p99, e.max, e.samples, e.sumOfSquares};
  report.set("boundary_error.p99_bound", e.p99Bound);
  report.set("boundary_error.bound", fit.bound);
  report.set("boundary_error.confidence", kCertificateConfidence);
  report.set("tolerance.wanted", options.fit.tolerance);
  report.set("tolerance.reached", e.p99);
  report.set("tolerance.met", fit.met);
  report.set("field.span", fit.span);
  report.set("field.free_share", fit.freeShare);
  context.print(fmt::format(
      "boundary error: rms {:.2e}, 99% {:.2e}, max {:.2e} of the values' span of {:.4g}; inside at "
      "most {:.2e}\n",
      e.rms, e.p99, e.max, fit.span, fit.bound));
  if (fit.met) return;
  const std::string text = fmt::format(
      "--tolerance {:g} is not met: 99% of the boundary lies within {:.3g} of the values' span, "
      "with "
      "{} charges; {}",
      options.fit.tolerance, e.p99, fit.sources, why(fit.end, options.fit));
  if (options.bestEffort)
    context.warning(text);
  else
    context.failAfterwards(text + "; what is written is marked so (--best-effort: exit code 0)");
}

Facts factsOf(const HarmonicFit& fit, const HarmonicOptions& options,
              const std::vector<std::string>& names) {
  const auto number = [](double value) { return fmt::format("{:.9g}", value); };
  return {{"version", versionText()},
          {"source", options.mesh},
          {"channels", fmt::format("{}", fmt::join(names, ","))},
          {"span", number(fit.span)},
          {"seed", fmt::format("{}", options.fit.seed)},
          {"tolerance", number(options.fit.tolerance)},
          {"tolerance_met", fit.met ? "true" : "false"},
          {"boundary_error_rms", number(fit.error.rms)},
          {"boundary_error_p99", number(fit.error.p99)},
          {"boundary_error_max", number(fit.error.max)},
          {"boundary_error_samples", fmt::format("{}", fit.error.samples)},
          {"inside_error_bound", number(fit.bound)},
          {"free_share", number(fit.freeShare)}};
}

void describe(const openvdb::GridPtrVec& grids, const Facts& facts) {
  for (const openvdb::GridBase::Ptr& grid : grids)
    for (const auto& [key, value] : facts)
      grid->insertMeta("innermap_" + key, openvdb::StringMetadata(value));
}

HarmonicGridSettings gridSettingsOf(const HarmonicOptions& options, const Context& context) {
  auto out = gridSettings<HarmonicGridSettings>(options.grid, context);
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

// Reads back as a field of any channels on the mesh that it was made for.
void writeFieldFile(const HarmonicOptions& options, const HarmonicField& field,
                    const SourceBoundary& boundary, const Facts& facts) {
  FieldFile file;
  file.steps = {field};
  file.facts = facts;
  file.boundary = file.boundaryTarget = boundary.mesh.vertices;
  file.boundaryTriangles = boundary.mesh.triangles;
  writeField(options.field, file);
}

}  // namespace

void addHarmonicOptions(Command& command, HarmonicOptions& o, const std::string& defaultGrids) {
  o.grids = defaultGrids;
  command.positional("MESH", &o.mesh, "mesh of the solid: .obj, .ply, .off or .stl");
  command.option("--output", "FILE", &o.output, "the grids, a .vdb file")
      .shortName("-o")
      .required()
      .writes({".vdb"});
  command
      .option("--field", "FILE", &o.field,
              "also the field itself in double precision, a .ply file of charges and weights")
      .writes({".ply"});
  command
      .option("--tolerance", "T", &o.fit.tolerance,
              "charges are added until 99% of the boundary lies within it; fraction of the values' "
              "span")
      .range(kSmallestTolerance, 1);
  command.option("--max-sources", "N", &o.fit.maxSources, "charges that the tolerance may take")
      .range(1000, 1000000)
      .advanced();
  command.flag("--best-effort", &o.bestEffort, "a tolerance that is not met is a warning");
  command.option("--seed", "N", &o.fit.seed, "of all random points").range(0, 1e15).advanced();
  addGridOptions(command, o.grid);
  command.option(
      "--grids", "LIST", &o.grids,
      "what is written of each channel, of value, gradient, direction (unit vectors) and "
      "magnitude");
  addNamesOption(command, o.names);
}

void runHarmonic(const HarmonicOptions& options,
                 const std::function<NamedConditions(const Mesh& mesh)>& conditionsOf, bool unitSum,
                 Context& context) {
  const HarmonicGridSettings grids = gridSettingsOf(options, context);
  context.output(options.output);
  if (!options.field.empty()) context.output(options.field);
  Mesh mesh = readMeshFile(options.mesh, context);
  const NamedConditions known = conditionsOf(mesh);
  const std::size_t vertices = mesh.vertices.size();
  const SourceBoundary boundary =
      makeSourceBoundary(std::move(mesh), context.settings<BoundarySettings>());
  reportSource(boundary, context);
  HarmonicFitSettings settings = context.settings(options.fit);
  FitMapSettings like;
  like.tolerance = settings.tolerance;
  const std::uint64_t need = std::max(
      fitMapMemory(like, vertices), harmonicGridMemory(boundary.solid, known.names.size(), grids));
  if (context.dryRun())
    return context.plan({fmt::format("fit {} channel(s) on {}", known.names.size(), options.mesh),
                         "write grids to " + options.output},
                        need);
  context.requireMemory("the harmonic field", need,
                        "use a lower --resolution or raise --max-memory");
  HarmonicFit fit = fitHarmonic(boundary, known.conditions, settings);
  if (unitSum) fit.field = withUnitSum(fit.field);
  reportHarmonic(fit, options, context);
  const Facts facts = factsOf(fit, options, known.names);
  HarmonicGridSettings evaluation = grids;
  evaluation.span = fit.span;
  const HarmonicGrids made = evaluateHarmonic(fit.field, boundary.solid, known.names, evaluation);
  for (const std::string& text : made.warnings) context.warning(text);
  addSeconds(context.report().seconds, made.seconds);
  context.report().grid = ReportGrid{made.voxelSize, made.activeVoxels, made.interiorVoxels};
  describe(made.all(), facts);
  writeGridFile(options.output, made.all(), options.names, context);
  if (!options.field.empty())
    context.timed("write", [&] { writeFieldFile(options, fit.field, boundary, facts); });
}

}  // namespace innermap::tool
