// `innermap push` and `innermap pull`: grids and geometry carried through a map, and back.
#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "block_share.h"
#include "carry_job.h"
#include "commands.h"
#include "geometry_transfer.h"
#include "innermap/core/memory.h"
#include "innermap/io/cell_file.h"
#include "innermap/tetra/cells.h"
#include "innermap/transfer/carry.h"
#include "inputs.h"
#include "report/report_figures.h"
#include "transfer_options.h"

namespace innermap::tool {
namespace {

struct CarryOptions {
  std::string map, volume, output, through;
  VerdictSettings verdict;
  TransferOptions transfer;
  GeometryOptions geometry;
  ShareOptions farm;
};

// What carries: the map, or a mesh that stands for it.
SolidMap mapOf(const CarryOptions& options, const MappedSolid& mapped, Context& context) {
  if (options.through.empty()) return mapped.map;
  const CellMesh mesh = context.timed("read", [&] { return readCells(options.through).mesh; });
  return linearMapOf(mesh, mapped);
}

CarryJob read(const CarryOptions& options, Context& context) {
  MappedSolid mapped = readMapFile(options.map, context);
  const OutsideSettings outside = outsideSettings(
      options.transfer, mapped.solid().repaired().mesh.vertices, mapped.boundary.target.moved);
  openvdb::GridPtrVec grids = readVolume(options.volume, options.transfer, context);
  Solid target = targetSolid(mapped, context);
  SolidMap map = mapOf(options, mapped, context);
  return {std::move(mapped), std::move(target), outside, std::move(grids), std::move(map)};
}

// A voxel size that nobody asked for is said where it is not the grids' own.
void noteVoxelSize(const openvdb::GridPtrVec& grids, const TransferOptions& options, double growth,
                   Context& context) {
  if (growth == 1 || options.grid.voxelSize || options.grid.resolution) return;
  const double from = finestVoxel(grids);
  context.used("--voxel-size", growth * from);
  context.note(
      fmt::format("voxels of {:.4g}: the grids' {:.4g} times {:.4g}, the growth of the solid; "
                  "choose others with --voxel-size",
                  growth * from, from, growth));
}

PushSettings pushSettings(const CarryJob& job, const TransferOptions& options) {
  PushSettings settings;
  settings.carry = carrySettings(options);
  settings.outside = job.outside;
  settings.accuracy = sumAccuracy(job.mapped);
  return settings;
}

// The voxels and the solid that grids are carried to.
LevelSetSettings outputOf(Way way, const CarryJob& job, const TransferOptions& options) {
  return outputSettings(job.grids, options.grid, growthOf(way, job));
}

std::string inputsOf(const CarryOptions& options) {
  std::string out = fingerprintOf(options.map) + " " + fingerprintOf(options.volume);
  return options.through.empty() ? out : out + " " + fingerprintOf(options.through);
}

PushResult pushed(const CarryJob& job, const CarryOptions& options, Context& context) {
  const TransferOptions& o = options.transfer;
  if (context.joined()) {
    const VolumePusher pusher(job.mapped.solid(), job.grids, pushSettings(job, o));
    const BlockPusher blocks(pusher, job.map, job.target, outputOf(Way::push, job, o));
    return blocks.join(readShares(options.output, inputsOf(options), context));
  }
  const openvdb::FloatGrid::Ptr levelSet =
      outputLevelSet(job.target, job.grids, o, context, growthOf(Way::push, job));
  return context.timed("push", [&] {
    return VolumePusher(job.mapped.solid(), job.grids, pushSettings(job, o))
        .push(job.map, *levelSet);
  });
}

openvdb::GridPtrVec push(const CarryJob& job, const CarryOptions& options, Context& context) {
  const PushResult result = pushed(job, options, context);
  reportPush(result, context);
  context.detail(pushText(result));
  const double volumes = volumeRatio(job.mapped.solid().volume(), job.target.volume());
  const double limit = options.transfer.carry.densityLimit;
  for (const CarriedMass& mass : result.masses)
    context.judge(judgeDensity({mass.name, "", std::min(mass.largestRatio, limit), volumes},
                               options.transfer.verdict));
  context.judge(judgeResampling(result.resampling, options.transfer.verdict));
  return result.grids;
}

// With the target's level set, which is none of the output's.
struct Puller {
  openvdb::FloatGrid::Ptr target;
  VolumePuller puller;
};

Puller pullerOf(const CarryJob& job, const TransferOptions& options, Context& context) {
  PullSettings settings;
  settings.carry = carrySettings(options);
  settings.outside = job.outside;
  settings.accuracy = sumAccuracy(job.mapped);
  const openvdb::FloatGrid::Ptr target =
      outputLevelSet(job.target, job.grids, TransferOptions(), context);
  settings.targetLevelSet = target.get();
  return {target, VolumePuller(job.map, job.mapped.solid(), job.grids, settings)};
}

PullResult pulled(const CarryJob& job, const CarryOptions& options, Context& context) {
  const TransferOptions& o = options.transfer;
  const Puller puller = pullerOf(job, o, context);
  if (context.joined())
    return puller.puller.join(outputOf(Way::pull, job, o),
                              readShares(options.output, inputsOf(options), context));
  const openvdb::FloatGrid::Ptr levelSet =
      outputLevelSet(job.mapped.solid(), job.grids, o, context, growthOf(Way::pull, job));
  return context.timed("pull", [&] { return puller.puller.pull(*levelSet); });
}

openvdb::GridPtrVec pull(const CarryJob& job, const CarryOptions& options, Context& context) {
  const PullResult result = pulled(job, options, context);
  for (const std::string& warning : result.warnings) context.warning(warning);
  context.report().add("pull", pulledFigures(result.voxels));
  context.detail(fmt::format("pulled {} grids, {} voxels\n", result.grids.size(), result.voxels));
  const double volumes = volumeRatio(job.target.volume(), job.mapped.solid().volume());
  const CarrySettings carry = carrySettings(options.transfer);
  for (const openvdb::GridBase::Ptr& grid : job.grids)
    if (result.resampling.largestGrowth > 0 && isDensity(*grid, carry))
      context.judge(
          judgeDensity({grid->getName(), "",
                        std::min(result.resampling.largestGrowth, carry.densityLimit), volumes},
                       options.transfer.verdict));
  context.judge(judgeResampling(result.resampling, options.transfer.verdict));
  return result.grids;
}

// What makes blocks is set up with the first of them.
std::function<GridBlock(const VoxelBlock&)> blockMaker(Way way, const CarryJob& job,
                                                       const CarryOptions& options,
                                                       Context& context) {
  const LevelSetSettings output = outputOf(way, job, options.transfer);
  if (way == Way::pull)
    return
        [&, output, puller = std::make_shared<std::optional<Puller>>()](const VoxelBlock& block) {
          if (!*puller) puller->emplace(pullerOf(job, options.transfer, context));
          return (*puller)->puller.pullBlock(output, block.origin);
        };
  return [&, output,
          pusher = std::make_shared<std::optional<BlockPusher>>()](const VoxelBlock& block) {
    if (!*pusher)
      pusher->emplace(
          VolumePusher(job.mapped.solid(), job.grids, pushSettings(job, options.transfer)), job.map,
          job.target, output);
    return (*pusher)->push(block);
  };
}

BlockWork blockWork(Way way, const CarryJob& job, const CarryOptions& options,
                    const std::vector<JobPhase>& phases, Context& context) {
  const bool pushes = way == Way::push;
  const Solid& solid = pushes ? job.target : job.mapped.solid();
  BlockWork work;
  work.output = options.output;
  work.inputs = inputsOf(options);
  work.stage = pushes ? "push" : "pull";
  work.doing = fmt::format("{} {} by {}", work.stage, options.volume, options.map);
  work.blocks = [&, way] {
    const LevelSetSettings output = outputOf(way, job, options.transfer);
    if (way == Way::pull) return voxelBlocks(solid, output);
    return pushBlocks(job.map, job.mapped.solid(), job.grids, pushSettings(job, options.transfer),
                      solid, output);
  };
  work.make = blockMaker(way, job, options, context);
  work.memory = carryBlockMemory(pushes ? job.mapped.solid() : job.target, job.grids,
                                 carrySettings(options.transfer), pushes);
  work.joinMemory =
      transferMemory(solid, job.grids, options.transfer, {pushes, 0}, growthOf(way, job));
  work.making = phases;
  work.joining = {phases.back(), phases.back()};
  return work;
}

// Peak need in bytes of carrying geometry, beyond what its file takes.
std::uint64_t carrierMemory(Way way, const Solid& source, const OutsideSettings& outside) {
  return way == Way::push ? levelSetMemory(source, {})
                          : carryMemory(source, {}, {}, outside, {}, {false, 0});
}

void runGeometry(Way way, const CarryOptions& options, Context& context) {
  const MappedSolid mapped = readMapFile(options.map, context);
  const Points& moved = mapped.boundary.target.moved;
  const OutsideSettings outside =
      outsideSettings(options.transfer, mapped.solid().repaired().mesh.vertices, moved);
  const std::uint64_t need =
      geometryMemory(options.volume) + carrierMemory(way, mapped.solid(), outside);
  if (!context.begins({fmt::format("{} {} by {}", way == Way::push ? "push" : "pull",
                                   options.volume, options.map),
                       "write " + options.output},
                      {"carrying " + options.volume, need, "cut the file into parts"}))
    return;
  const auto file = readGeometryFile(options.volume, options.geometry, context);
  const CarryPointsSettings settings = carryPointsSettings(outside, sumAccuracy(mapped));
  const bool push = way == Way::push;
  const SolidMap map = mapOf(options, mapped, context);
  const PointCarry carry = context.timed(push ? "level set" : "invert",
                                         [&] { return carryByMap(map, mapped, push, settings); });
  const PointCarry whole = fromInput(carry, context);
  const double diagonal = push ? boundingBox(moved).diagonal() : mapped.solid().diagonal();
  const CarryGeometrySettings how{options.geometry.subdivide * diagonal, options.geometry.splats,
                                  mapped.injectivity.mirrored};
  const CarriedGeometry carried =
      context.timed("carry", [&] { return carryGeometry(*file, whole, how); });
  warnOf(carried, options.transfer, "", context);
  context.detail(reportGeometry(carried, context));
  context.judge(judgeMap(mapped, nullptr, options.verdict, MapOrigin::file));
  writeGeometryFile(options.output, *file, carried, context);
}

void run(Way way, const CarryOptions& options, Context& context) {
  requireFitting(options.volume, options.output, options.transfer, options.geometry);
  const bool geometry = isGeometryFile(options.volume);
  if (geometry && inShares(options.farm))
    throw UsageError(
        "--share and --jobs: geometry is carried in one run, a million points in a second and a "
        "million splats in some seven; leave them out");
  if (options.transfer.outside > 0 && inShares(options.farm))
    throw UsageError(
        "--outside: what lies around the solid is carried in one run; leave out --share and "
        "--jobs");
  beginBlocks(options.farm, options.output, context);
  if (geometry) return runGeometry(way, options, context);
  const CarryJob job = read(options, context);
  const Solid& solid = way == Way::push ? job.target : job.mapped.solid();
  const double growth = growthOf(way, job);
  const CarryKind kind{way == Way::push, 0};
  const std::vector<JobPhase> phases = carryingPhases(way, job, options.transfer, growth);
  context.expect(phases);
  if (madeInShares(options.farm, blockWork(way, job, options, phases, context), context)) return;
  if (context.dryRun())
    return context.plan({fmt::format("{} {} grids of {} by {}", way == Way::push ? "push" : "pull",
                                     job.grids.size(), options.volume, options.map),
                         "write " + options.output},
                        transferMemory(solid, job.grids, options.transfer, kind, growth));
  requireTransferMemory(solid, job.grids, options.transfer, context, kind, growth);
  noteVoxelSize(job.grids, options.transfer, growth, context);
  const openvdb::GridPtrVec grids = (way == Way::push ? push : pull)(job, options, context);
  context.judge(judgeMap(job.mapped, nullptr, options.verdict, MapOrigin::file));
  describeMap(grids, job.mapped);
  writeGridFile(options.output, grids, options.transfer.names, context);
}

// inputSpace: where the grids live.
Command makeCarryCommand(Way way, const std::string& name, const std::string& summary,
                         const std::string& inputSpace) {
  auto o = std::make_shared<CarryOptions>();
  Command c(name, summary);
  c.positional("MAP", &o->map, "a map.ply written by fit or map");
  c.positional("INSIDE", &o->volume,
               "the things to carry, in the " + inputSpace +
                   "'s world space: grids (.vdb) or geometry (.obj, .ply, .off, .stl; cells in "
                   ".vtu, .msh, .mesh)");
  c.option("--output", "FILE", &o->output,
           "the file to write, of the same kind; cells may change theirs")
      .shortName("-o")
      .required();
  c.option("--through", "CELLS", &o->through,
           "use the piecewise linear map of this mesh from remesh (.vtu or .msh) instead; the "
           "result agrees with the mesh and folds nowhere")
      .reads();
  addTransferOptions(c, o->transfer);
  addGeometryOptions(c, o->geometry, true);
  c.settings(describe(o->verdict));
  addBlockOptions(c, o->farm);
  c.addSpace();
  c.run([o, way](Context& context) { run(way, *o, context); });
  return c;
}

}  // namespace

Command makePushCommand() {
  Command c = makeCarryCommand(Way::push, "push",
                               "Carry grids or geometry inside a map's source solid to its target",
                               "source");
  c.description(
      "For each voxel of the target, push finds the point of the source that the map brings there, "
      "by Newton's method, and samples the grids at it. Scalars keep their values. Vectors move by "
      "their vector type (invariant, covariant, contravariant). Level sets become distances again. "
      "Densities (--density) are not sampled: push carries the mass of each source voxel to its "
      "image, so no mass is lost. Output voxels are active inside the target and in a skin of two "
      "voxels. For geometry, each point goes where the map takes it. The Jacobian turns vectors, "
      "and its inverse transpose turns normals; the rest of the file stays. Gaussian splats (.ply "
      "with scale_0, rot_0 and opacity) stretch and turn with their colours. push leaves out "
      "points farther outside the solid than --outside (and 0.001 of the diagonal) and all that "
      "uses them, unless --fade-to says where they go.");
  c.example("innermap push map.ply smoke.vdb -o posed.vdb --grids density --density");
  c.example("innermap push map.ply fem.vdb -o posed.vdb --stress stress --resolution 256");
  c.example("innermap push map.ply mist.vdb -o posed.vdb --outside 0.1 --fade-to fitted");
  c.example("innermap push map.ply bones.obj -o posed.obj --subdivide 0.001");
  c.example("innermap push map.ply capture.ply -o posed.ply --outside 0.02");
  c.example("innermap push map.ply muscle.vtu -o posed.msh --vectors fibre");
  return c;
}

Command makePullCommand() {
  Command c = makeCarryCommand(
      Way::pull, "pull", "Bring grids or geometry inside a map's target back to its source solid",
      "target");
  c.description(
      "Each voxel p of the source gets the grids' values at f(p), where the map brings it. "
      "Otherwise pull works like push, in the other direction.");
  c.example("innermap pull map.ply posed.vdb -o rest.vdb");
  c.example("innermap pull map.ply posed.obj -o bones.obj");
  return c;
}

}  // namespace innermap::tool
