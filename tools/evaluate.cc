// `innermap evaluate`: a saved map on the voxels of its solid.
#include <fmt/format.h>

#include "commands.h"
#include "evaluation.h"

namespace innermap::tool {
namespace {

struct EvaluateOptions {
  std::string map, output;
  EvaluationOptions evaluation;
};

// The boundaries that the fit had stand in the map's file.
BoundaryPair boundaryOf(const FieldFile& file, const std::string& path, Context& context) {
  if (file.boundaryTriangles.empty())
    throw FileError(path, "holds no boundary; write it with innermap fit or map");
  Mesh source;
  source.name = path;
  source.vertices = file.boundary;
  source.triangles = file.boundaryTriangles;
  Mesh target = source;
  target.vertices = file.boundaryTarget;
  for (const auto& [key, value] : file.settings) {
    if (key == "source") source.name = value;
    if (key == "target") target.name = value;
  }
  validate(source);
  validate(target);
  return makeBoundaryPair(std::move(source), std::move(target), context);
}

void run(const EvaluateOptions& options, Context& context) {
  context.willWrite(options.output);
  std::optional<FieldFile> file;
  context.timed("read", [&] { file.emplace(readField(options.map)); });
  if (file->field.channels() != 3)
    throw FileError(options.map,
                    fmt::format("has {} channels; a map has 3", file->field.channels()));
  const BoundaryPair pair = boundaryOf(*file, options.map, context);
  const std::uint64_t need = evaluationMemory(pair.solid, options.evaluation);
  if (context.dryRun())
    return context.plan({"evaluate " + options.map, "write grids to " + options.output}, need);
  requireEvaluationMemory(pair.solid, options.evaluation, context);
  const openvdb::GridPtrVec grids = evaluateGrids(pair, *file, options.evaluation, context);
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
