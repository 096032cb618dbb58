// `innermap evaluate`: a saved map on the voxels of its solid.
#include "commands.h"
#include "grid_options.h"
#include "inputs.h"
#include "job_cost.h"
#include "map_report.h"
#include "report/verdict.h"

namespace innermap::tool {
namespace {

struct EvaluateOptions {
  std::string map, output;
  EvaluationOptions evaluation;
  VerdictSettings verdict;
};

void run(const EvaluateOptions& options, Context& context) {
  context.output(options.output);
  const MappedSolid mapped = readMapFile(options.map, context);
  const MapGridSettings settings = mapGridSettings(options.evaluation);
  context.expect(evaluationPhases(jobSize(mapped.solid(), settings, mapped.map.sources())));
  requireInterior(mapped.solid(), options.evaluation.grid.in<LevelSetSettings>());
  if (context.dryRun())
    return context.plan({"evaluate " + options.map, "write grids to " + options.output},
                        mapGridMemory(mapped.solid(), settings, mapGridKind(mapped)));
  requireEvaluationMemory(mapped.solid(), options.evaluation.grid, context, mapGridKind(mapped));
  context.spend(Context::kMostOfTime);
  const SolidGrids grids = evaluateOnGrid(mapped, settings);
  reportGrids(grids, settings.lame, context);
  context.judge(judgeMap(mapped, &grids, options.verdict, MapOrigin::file));
  writeGridFile(options.output, grids.all(), options.evaluation.names, context);
}

}  // namespace

Command makeEvaluateCommand() {
  auto o = std::make_shared<EvaluateOptions>();
  Command c("evaluate", "Evaluate a saved map on the voxels of its solid");
  c.description(
      "Writes the grids surface, density, map, jacobian, harmonic_energy and deformation_energy; "
      "values are active inside and in a skin of two voxels. Energies' totals, the least Jacobian, "
      "the folded share and what is known of one-to-one stand in the metadata and the report. "
      "Where there are such, `folded` marks the voxels that the map folds, `outside` how far "
      "images lie outside the target. Far "
      "from the origin, where floats do not hold positions well, also map_local: positions less "
      "its metadata innermap_map_local_origin.");
  c.positional("MAP", &o->map, "a map.ply written by fit or map");
  c.option("--output", "FILE", &o->output, "the grids, a .vdb file")
      .shortName("-o")
      .required()
      .writes({".vdb"});
  c.limitTime("after which folds are no longer repaired");
  addEvaluationOptions(c, o->evaluation);
  c.settings(describe(o->verdict));
  c.example("innermap evaluate map.ply -o map.vdb --resolution 256");
  c.example("innermap evaluate map.ply -o map.vdb --voxel-size 0.01 --names blender");
  c.run([o](Context& context) { run(*o, context); });
  return c;
}

}  // namespace innermap::tool
