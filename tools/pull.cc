// `innermap pull`: grids that live in a map's target, brought back to its source solid.
#include <fmt/format.h>

#include "commands.h"
#include "innermap/io/vdb/vdb_file.h"
#include "innermap/levelset/level_set.h"
#include "map_report.h"
#include "transfer_options.h"

namespace innermap::tool {
namespace {

struct PullOptions {
  std::string map, volume, output;
  TransferOptions transfer;
};

void run(const PullOptions& options, Context& context) {
  context.output(options.output);
  const MappedSolid mapped = readMapFile(options.map, context);
  PullSettings settings;
  settings.carry = carrySettings(options.transfer);
  settings.outside = outsideSettings(options.transfer, mapped.solid().repaired().mesh.vertices,
                                     mapped.boundary.target.moved);
  settings.accuracy = sumAccuracy(mapped);
  settings.maxMemory = context.maxMemory();
  settings.progress = context.progress();
  const openvdb::GridPtrVec grids = readVolume(options.volume, options.transfer, context);
  std::optional<Solid> target;
  context.timed("solid",
                [&] { target.emplace(makeTargetSolid(mapped.boundary, {context.progress()})); });
  if (context.dryRun())
    return context.plan(
        {fmt::format("pull {} grids of {} by {}", grids.size(), options.volume, options.map),
         "write " + options.output},
        transferMemory(mapped.solid(), grids, options.transfer));
  requireTransferMemory(mapped.solid(), grids, options.transfer, context);
  TransferOptions plain;  // the target's level set is none of the output's
  const openvdb::FloatGrid::Ptr targetLevelSet = outputLevelSet(*target, grids, plain, context);
  settings.targetLevelSet = targetLevelSet.get();
  const openvdb::FloatGrid::Ptr levelSet =
      outputLevelSet(mapped.solid(), grids, options.transfer, context);
  PullResult result;
  context.timed(
      "pull", [&] { result = pullGrids(mapped.map, mapped.solid(), *levelSet, grids, settings); });
  for (const std::string& warning : result.warnings) context.warning(warning);
  context.report().set("pull.voxels", static_cast<std::int64_t>(result.voxels));
  describeMap(result.grids, mapped);
  context.timed("write",
                [&] { writeVolume(options.output, result.grids, options.transfer, context); });
  context.print(fmt::format("pulled {} grids, {} voxels\n", result.grids.size(), result.voxels));
}

}  // namespace

Command makePullCommand() {
  auto o = std::make_shared<PullOptions>();
  Command c("pull", "Bring grids that live in a map's target back to its source solid");
  c.description(
      "Each voxel p of the source gets the grids' values at f(p), where the map brings it. "
      "Everything else is as with push, the other way round.");
  c.positional("MAP", &o->map, "a map.ply written by fit or map");
  c.positional("VOLUME", &o->volume, "the grids, a .vdb file in the target's world space");
  c.option("--output", "FILE", &o->output, "the .vdb file to write").shortName("-o").required();
  addTransferOptions(c, o->transfer);
  c.example("innermap pull map.ply posed.vdb -o rest.vdb");
  c.run([o](Context& context) { run(*o, context); });
  return c;
}

}  // namespace innermap::tool
