// `innermap fit`: two meshes to a map.
#include "commands.h"
#include "fitting_options.h"
#include "innermap/mesh/mesh_file.h"
#include "inputs.h"
#include "job_cost.h"
#include "map_report.h"
#include "report/verdict.h"

namespace innermap::tool {
namespace {

struct FitOptions {
  std::string source, target, output;
  FittingOptions fitting;
  VerdictSettings verdict;
};

void run(const FitOptions& options, Context& context) {
  checkFittingOptions(options.fitting);
  context.output(options.output);
  Mesh source = readMeshFile(options.source, context);
  requireMeshMemory(options.target, context);
  Mesh target = context.timed("read", [&] {
    return inOutput(options.target, readMeshLike(options.target, source), context);
  });
  const FitMapSettings settings = fitMapSettings(options.fitting, source.vertices.size());
  const double places = bentPlaces(source, target.vertices, settings.tolerance);
  BoundaryPair pair = makeBoundaryPair(std::move(source), std::move(target));
  reportBoundaries(pair, context);
  const std::size_t vertices = pair.source.mesh.vertices.size();
  context.expect(fittingPhases(settings, places, false));
  if (!context.begins({fittingPlan(settings), "write the map to " + options.output},
                      fitNeed(settings, vertices)))
    return;
  context.phase("fitting");
  context.spend(Context::kMostOfTime);
  const MapFit fit = fitMap(std::move(pair), settings);
  reportFit(fit, settings, options.fitting.bestEffort, context);
  reportInjectivity(fit.injectivity, context);
  context.judge(judgeMap(fit, nullptr, options.verdict, MapOrigin::related, settings));
  context.timed("write", [&] { writeMap(options.output, fit); });
}

}  // namespace

Command makeFitCommand() {
  auto o = std::make_shared<FitOptions>();
  Command c("fit", "Fit a harmonic map to two meshes of the same connectivity");
  c.description(
      "Places charges outside the source solid and finds their weights, with which the map meets "
      "the target on the boundary. The file holds charges and weights in double precision, and "
      "both boundaries. Its certificate is the error at 20,000 boundary points that took no part "
      "in the fit.");
  c.positional("SOURCE", &o->source, "mesh of the solid: .obj, .ply, .off or .stl");
  c.positional("TARGET", &o->target, "the same mesh with its vertices moved");
  c.outputFile(&o->output, {".ply"}, "the map, a .ply file");
  c.limitTime("stop refining and stepping after this time");
  addFittingOptions(c, o->fitting);
  c.settings(describe(o->verdict));
  c.addSpace();
  c.example("innermap fit rest.obj pose.obj -o map.ply");
  c.example("innermap fit rest.obj pose.obj -o map.ply --tolerance 1e-4 --best-effort");
  c.example("innermap fit rest.obj pose.obj -o map.ply --charges 4000 --distance 0.02");
  return c.running(o, run);
}

}  // namespace innermap::tool
