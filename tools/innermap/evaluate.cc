// `innermap evaluate`: a saved map on the voxels of its solid.
#include "block_share.h"
#include "commands.h"
#include "core/file.h"
#include "core/file_bytes.h"
#include "core/text_scanner.h"
#include "grid_options.h"
#include "innermap/io/volume_texture.h"
#include "innermap/transfer/inverse_map.h"
#include "inputs.h"
#include "job_cost.h"
#include "map_report.h"
#include "report/figures.h"
#include "report/verdict.h"
#include "transfer_options.h"

namespace innermap::tool {
namespace {

struct EvaluateOptions {
  std::string map, output;
  bool inverse = false;
  EvaluationOptions evaluation;
  VerdictSettings verdict;
  ShareOptions farm;
};

// .nii or .nii.gz; what is no regular file may be called anything, and gets grids.
bool isDisplacementField(const std::string& path) {
  const std::string ending = extensionOf(path);
  return equalsIgnoringCase(ending, ".nii") || equalsIgnoringCase(ending, ".gz");
}

// Throws UsageError for what only maps' grids heed.
void requireInverseOptions(const EvaluateOptions& o) {
  const EvaluateOptions plain;
  const std::pair<const char*, bool> given[] = {
      {"--repair", o.evaluation.repair != plain.evaluation.repair},
      {"--lame-lambda", o.evaluation.lame.lambda != plain.evaluation.lame.lambda},
      {"--lame-mu", o.evaluation.lame.mu != plain.evaluation.lame.mu},
      {"--warn-folded", o.verdict.maxFolded != plain.verdict.maxFolded},
      {"--warn-outside", o.verdict.maxOutside != plain.verdict.maxOutside},
      {"--warn-crossings", o.verdict.maxCrossings != plain.verdict.maxCrossings}};
  for (const auto& [option, changed] : given)
    if (changed)
      throw UsageError(std::string(option) + ": does nothing with --inverse; leave it out");
}

std::vector<JobPhase> inversePhases(const JobSize& size) {
  return {stageOf("level set", size), stageOf("covering the target", size),
          stageOf("inverting the map", size), stageOf("writing the VDB file", size)};
}

// Where each voxel of the target comes from.
void runInverse(const EvaluateOptions& options, const MappedSolid& mapped, Context& context) {
  const Solid target = targetSolid(mapped, context);
  const auto settings = options.evaluation.grid.in<LevelSetSettings>();
  requireInterior(target, settings);
  context.expect(inversePhases(jobSize(target, settings, mapped.map.sources())));
  const auto need = [&](const LatticeChoice& grid) {
    return carryMemory(target, {}, grid.in<LevelSetSettings>());
  };
  if (!context.begins({"invert " + options.map + " on its target's voxels",
                       "write the displacement to " + options.output},
                      gridNeed("inverting the map on a grid", options.evaluation.grid, need)))
    return;
  const openvdb::FloatGrid::Ptr levelSet =
      context.timed("level set", [&] { return makeLevelSet(target, settings); });
  InverseSettings inverse;
  inverse.accuracy = sumAccuracy(mapped);
  const BackwardDisplacement back = context.timed("inverse", [&] {
    return backwardDisplacement(mapped.map, mapped.solid(), *levelSet, inverse);
  });
  context.report().add("inverse", figures(back.statistics));
  if (const std::string warning = back.statistics.warning(); !warning.empty())
    context.warning(warning);
  context.print(inverseText(back.statistics));
  if (isDisplacementField(options.output))
    context.timed("write", [&] { return writeDisplacementField(options.output, *back.grid); });
  else
    writeGridFile(options.output, {levelSet, back.grid}, options.evaluation.names, context);
}

BlockWork blockWork(const EvaluateOptions& options, const MappedSolid& mapped,
                    const MapGridSettings& settings) {
  BlockWork work =
      evaluationWork(mapped.solid(), options.evaluation, mapped.map.sources(), mapGridKind(mapped));
  work.output = options.output;
  work.inputs = fingerprintOf(options.map);
  work.doing = "evaluate " + options.map;
  work.make = [&](const VoxelBlock& block) {
    return evaluateBlock(mapped, settings, block.origin);
  };
  return work;
}

SolidGrids makeGrids(const EvaluateOptions& options, const MappedSolid& mapped,
                     const MapGridSettings& settings, Context& context) {
  if (!context.joined()) return evaluateOnGrid(mapped, settings);
  return joinBlocks(mapped, settings,
                    readShares(options.output, fingerprintOf(options.map), context));
}

void run(const EvaluateOptions& options, Context& context) {
  if (!options.inverse && isDisplacementField(options.output))
    throw UsageError("--output: only the displacement of --inverse is written to " +
                     options.output + "; name a .vdb file, or give --inverse");
  if (options.inverse && inShares(options.farm))
    throw UsageError("--inverse: cannot be cut into shares; leave out --share and --jobs");
  if (options.inverse) requireInverseOptions(options);
  beginBlocks(options.farm, options.output, context);
  const MappedSolid mapped = readMapFile(options.map, context);
  if (options.inverse) return runInverse(options, mapped, context);
  const MapGridSettings settings = mapGridSettings(options.evaluation);
  context.expect(evaluationPhases(jobSize(mapped.solid(), settings, mapped.map.sources())));
  if (madeInShares(options.farm, blockWork(options, mapped, settings), context)) return;
  requireInterior(mapped.solid(), options.evaluation.grid.in<LevelSetSettings>());
  if (!context.begins({"evaluate " + options.map, "write grids to " + options.output},
                      mapGridNeed(mapped.solid(), options.evaluation.grid, mapGridKind(mapped))))
    return;
  context.spend(Context::kMostOfTime);
  const SolidGrids grids = makeGrids(options, mapped, settings, context);
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
      "values are active inside and in a skin of two voxels. The metadata and the report have the "
      "energies' totals, the least Jacobian, the folded share, and whether the map is one-to-one. "
      "If the map folds voxels, the grid `folded` marks them. If images lie outside the target, "
      "`outside` says how far. (Only innermap map writes `undecided`, the voxels that its proof "
      "left open.) Far from the origin, where floats hold positions badly, evaluate also writes "
      "map_local: positions minus the point in its metadata innermap_map_local_origin.");
  c.positional("MAP", &o->map, "a map.ply written by fit or map");
  c.option("--output", "FILE", &o->output,
           "the grids, a .vdb file; with --inverse also .nii or .nii.gz: a displacement field for "
           "ANTs, ITK and Slicer (LPS)")
      .shortName("-o")
      .required()
      .writes({".vdb", ".nii", ".nii.gz"});
  c.flag("--inverse", &o->inverse,
         "write the inverse map instead, on the voxels of the target: the grids surface and "
         "displacement, from each voxel to where it comes from; other programs resample images of "
         "the source by it");
  c.limitTime("stop repairing folds after this time");
  addEvaluationOptions(c, o->evaluation);
  c.settings(describe(o->verdict));
  addBlockOptions(c, o->farm);
  c.example("innermap evaluate map.ply -o map.vdb --resolution 256");
  c.example("innermap evaluate map.ply -o map.vdb --voxel-size 0.01 --names blender");
  c.example("innermap evaluate map.ply -o field.nii.gz --inverse");
  return c.running(o, run);
}

}  // namespace innermap::tool
