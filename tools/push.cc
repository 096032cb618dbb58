// `innermap push`: grids that live in a map's source solid, carried to its target.
#include <fmt/format.h>

#include <algorithm>

#include "commands.h"
#include "innermap/evaluate/evaluate_map.h"
#include "innermap/io/vdb/vdb_file.h"
#include "map_report.h"
#include "transfer_options.h"

namespace innermap::tool {
namespace {

struct PushOptions {
  std::string map, volume, output;
  TransferOptions transfer;
};

void run(const PushOptions& options, Context& context) {
  context.output(options.output);
  const MappedSolid mapped = readMapFile(options.map, context);
  PushSettings settings = pushSettings(options.transfer, mapped.solid().repaired().mesh.vertices,
                                       mapped.boundary.target.moved, context);
  settings.accuracy = sumAccuracy(mapped);
  const openvdb::GridPtrVec grids = readVolume(options.volume, options.transfer, context);
  std::optional<Solid> target;
  context.timed("solid",
                [&] { target.emplace(makeTargetSolid(mapped.boundary, {context.progress()})); });
  if (context.dryRun())
    return context.plan(
        {fmt::format("push {} grids of {} by {}", grids.size(), options.volume, options.map),
         "write " + options.output},
        transferMemory(*target, grids, options.transfer));
  requireTransferMemory(*target, grids, options.transfer, context);
  const openvdb::FloatGrid::Ptr levelSet =
      outputLevelSet(*target, grids, options.transfer, context);
  PushResult result;
  context.timed("push", [&] {
    const VolumePusher pusher(mapped.solid(), grids, settings);
    result = pusher.push(mapped.map, *levelSet);
  });
  reportPush(result, context);
  describeMap(result.grids, mapped);
  context.timed("write",
                [&] { writeVolume(options.output, result.grids, options.transfer, context); });
  context.print(pushText(result));
}

}  // namespace

Command makePushCommand() {
  auto o = std::make_shared<PushOptions>();
  Command c("push", "Carry grids that live in a map's source solid to its target");
  c.description(
      "For each voxel of the target the point of the source that the map brings there is found, by "
      "Newton's method, and the grids are sampled at it. Scalars keep their values, or with "
      "--density their mass; vectors move by their vector type (invariant, covariant, "
      "contravariant); level sets become distances again. Output voxels are active inside the "
      "target and in a skin of two voxels.");
  c.positional("MAP", &o->map, "a map.ply written by fit or map");
  c.positional("VOLUME", &o->volume, "the grids, a .vdb file in the source's world space");
  c.option("--output", "FILE", &o->output, "the .vdb file to write").shortName("-o").required();
  addTransferOptions(c, o->transfer);
  c.example("innermap push map.ply smoke.vdb -o posed.vdb --grids density --density");
  c.example("innermap push map.ply fem.vdb -o posed.vdb --stress stress --resolution 256");
  c.example("innermap push map.ply mist.vdb -o posed.vdb --outside 0.1 --fade-to fitted");
  c.run([o](Context& context) { run(*o, context); });
  return c;
}

}  // namespace innermap::tool
