// `innermap evaluate`: a saved map on the voxels of its solid.
#include <fmt/format.h>

#include "commands.h"
#include "evaluation.h"
#include "saved_map.h"

namespace innermap::tool {
namespace {

struct EvaluateOptions {
  std::string map, output;
  EvaluationOptions evaluation;
};

void run(const EvaluateOptions& options, Context& context) {
  context.output(options.output);
  const FieldFile file = readMap(options.map, context);
  const BoundaryPair pair = boundaryOf(file, options.map, context);
  const std::uint64_t need = evaluationMemory(pair.solid, options.evaluation);
  if (context.dryRun())
    return context.plan({"evaluate " + options.map, "write grids to " + options.output}, need);
  requireEvaluationMemory(pair.solid, options.evaluation, context);
  const openvdb::GridPtrVec grids = evaluateGrids(pair, file, options.evaluation, context);
  context.timed("write", [&] { writeGrids(options.output, grids, options.evaluation, context); });
  context.print(evaluationText(context.report()));
}

}  // namespace

Command makeEvaluateCommand() {
  auto o = std::make_shared<EvaluateOptions>();
  Command c("evaluate", "Evaluate a saved map on the voxels of its solid");
  c.description(
      "Writes the grids surface, density, map, jacobian, harmonic_energy and deformation_energy; "
      "values are active inside and in a skin of two voxels. Energies' totals, the least Jacobian "
      "and the folded share of the volume stand in the grids' metadata and the report.");
  c.positional("MAP", &o->map, "a map.ply written by fit or map");
  c.option("--output", "FILE", &o->output, "the grids, a .vdb file").shortName("-o").required();
  addEvaluationOptions(c, o->evaluation);
  c.example("innermap evaluate map.ply -o map.vdb --resolution 256");
  c.example("innermap evaluate map.ply -o map.vdb --voxel-size 0.01 --names blender");
  c.run([o](Context& context) { run(*o, context); });
  return c;
}

}  // namespace innermap::tool
