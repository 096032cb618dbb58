// `innermap fit`: two meshes to a map.
#include <fmt/format.h>

#include "boundary_pair.h"
#include "commands.h"
#include "fitting.h"

namespace innermap::tool {
namespace {

struct FitOptions {
  std::string source, target, output;
  FittingOptions fitting;
};

void run(const FitOptions& options, Context& context) {
  toleranceOf(options.fitting);  // refuses options that cannot be before anything is read
  context.output(options.output);
  const BoundaryPair pair = readBoundaryPair(options.source, options.target, context);
  const std::size_t vertices = pair.source.vertices.size();
  const std::uint64_t need = fittingMemory(options.fitting, vertices);
  if (context.dryRun())
    return context.plan(
        {fittingPlan(options.fitting, vertices), "write the map to " + options.output}, need);
  requireFittingMemory(options.fitting, vertices, context);
  const Fitted fitted = fitMap(pair, options.fitting, context);
  context.timed("write", [&] { writeField(options.output, fitted.file); });
  context.print(fmt::format("boundary error: rms {:.2e}, 99% {:.2e}, max {:.2e} of the diagonal\n",
                            fitted.error.rms, fitted.error.p99, fitted.error.max));
}

}  // namespace

Command makeFitCommand() {
  auto o = std::make_shared<FitOptions>();
  Command c("fit", "Fit a harmonic map to two meshes of the same connectivity");
  c.description(
      "Charges outside the source solid are weighted so that the map meets the target on the "
      "boundary. The file holds charges and weights in double precision and both boundaries; its "
      "certificate is the error at 20,000 boundary points that took no part in the fit.");
  c.positional("SOURCE", &o->source, "mesh of the solid: .obj, .ply, .off or .stl");
  c.positional("TARGET", &o->target, "the same mesh with its vertices moved");
  c.option("--output", "FILE", &o->output, "the map, a .ply file").shortName("-o").required();
  addFittingOptions(c, o->fitting);
  c.example("innermap fit rest.obj pose.obj -o map.ply");
  c.example("innermap fit rest.obj pose.obj -o map.ply --tolerance 1e-4 --best-effort");
  c.example("innermap fit rest.obj pose.obj -o map.ply --sources 4000 --distance 0.02");
  c.run([o](Context& context) { run(*o, context); });
  return c;
}

}  // namespace innermap::tool
