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
#include "innermap/transfer/carry.h"
#include "innermap/transfer/inverse_map.h"
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

const char* wordOf(bool push) { return push ? "push" : "pull"; }

// What carries: the map, or a mesh that stands for it.
SolidMap mapOf(const CarryOptions& options, const MappedSolid& mapped, Context& context) {
  if (options.through.empty()) return mapped.map;
  const CellMesh mesh = context.timed("read", [&] { return readCells(options.through).mesh; });
  return linearMapOf(mesh, mapped);
}

CarryJob read(bool push, const CarryOptions& options, Context& context) {
  auto mapped = std::make_shared<const MappedSolid>(readMapFile(options.map, context));
  const TransferOptions& o = options.transfer;
  const OutsideSettings outside = outsideSettings(o.outside, fadeTo(o), *mapped);
  openvdb::GridPtrVec grids = readVolume(options.volume, o, context);
  Solid target = targetSolid(*mapped, context);
  SolidMap map = mapOf(options, *mapped, context);
  return {push,    mapped, std::move(target), std::move(map), std::move(grids), carrySettings(o),
          outside, o.grid};
}

// A voxel size that nobody asked for is said where it is not the grids' own.
void noteVoxelSize(const CarryJob& job, Context& context) {
  const double growth = job.growth();
  if (growth == 1 || job.lattice.voxelSize || job.lattice.resolution) return;
  const double from = finestVoxel(job.grids);
  context.used("--voxel-size", growth * from);
  context.note(
      fmt::format("voxels of {:.4g}: the grids' {:.4g} times {:.4g}, the growth of the solid; "
                  "choose others with --voxel-size",
                  growth * from, from, growth));
}

openvdb::FloatGrid::Ptr outputLevelSet(const CarryJob& job, Context& context) {
  return context.timed("level set", [&] { return makeLevelSet(job.to(), job.output()); });
}

std::string inputsOf(const CarryOptions& options) {
  std::string out = fingerprintOf(options.map) + " " + fingerprintOf(options.volume);
  return options.through.empty() ? out : out + " " + fingerprintOf(options.through);
}

PushResult pushed(const CarryJob& job, const CarryOptions& options, Context& context) {
  if (context.joined()) {
    const BlockPusher blocks(pusherOf(job), job.map, job.target, job.output());
    return blocks.join(readShares(options.output, inputsOf(options), context));
  }
  const openvdb::FloatGrid::Ptr levelSet = outputLevelSet(job, context);
  return context.timed("push", [&] { return pusherOf(job).push(job.map, *levelSet); });
}

openvdb::GridPtrVec push(const CarryJob& job, const CarryOptions& options, Context& context) {
  const PushResult result = pushed(job, options, context);
  reportPush(result, context);
  context.detail(pushText(result));
  const double volumes = volumeRatio(job.from().volume(), job.to().volume());
  const double limit = options.transfer.carry.densityLimit;
  for (const CarriedMass& mass : result.masses)
    context.judge(judgeDensity({mass.name, "", std::min(mass.largestRatio, limit), volumes},
                               options.transfer.verdict));
  context.judge(judgeResampling(result.resampling, options.transfer.verdict));
  return result.grids;
}

PullResult pulled(const CarryJob& job, const CarryOptions& options, Context& context) {
  const Puller puller = context.timed("level set", [&] { return pullerOf(job); });
  if (context.joined())
    return puller.puller.join(job.output(), readShares(options.output, inputsOf(options), context));
  const openvdb::FloatGrid::Ptr levelSet = outputLevelSet(job, context);
  return context.timed("pull", [&] { return puller.puller.pull(*levelSet); });
}

openvdb::GridPtrVec pull(const CarryJob& job, const CarryOptions& options, Context& context) {
  const PullResult result = pulled(job, options, context);
  for (const std::string& warning : result.warnings) context.warning(warning);
  context.report().add("pull", pulledFigures(result.voxels));
  context.detail(fmt::format("pulled {} grids, {} voxels\n", result.grids.size(), result.voxels));
  const double volumes = volumeRatio(job.from().volume(), job.to().volume());
  for (const openvdb::GridBase::Ptr& grid : job.grids)
    if (result.resampling.largestGrowth > 0 && isDensity(*grid, job.carry))
      context.judge(
          judgeDensity({grid->getName(), "",
                        std::min(result.resampling.largestGrowth, job.carry.densityLimit), volumes},
                       options.transfer.verdict));
  context.judge(judgeResampling(result.resampling, options.transfer.verdict));
  return result.grids;
}

// What makes blocks is set up with the first of them.
std::function<GridBlock(const VoxelBlock&)> blockMaker(const CarryJob& job, Context& context) {
  const LevelSetSettings output = job.output();
  if (!job.push)
    return
        [&, output, puller = std::make_shared<std::optional<Puller>>()](const VoxelBlock& block) {
          if (!*puller) puller->emplace(context.timed("level set", [&] { return pullerOf(job); }));
          return (*puller)->puller.pullBlock(output, block.origin);
        };
  return [&, output,
          pusher = std::make_shared<std::optional<BlockPusher>>()](const VoxelBlock& block) {
    if (!*pusher) pusher->emplace(pusherOf(job), job.map, job.target, output);
    return (*pusher)->push(block);
  };
}

BlockWork blockWork(const CarryJob& job, const CarryOptions& options,
                    const std::vector<JobPhase>& phases, Context& context) {
  BlockWork work;
  work.output = options.output;
  work.inputs = inputsOf(options);
  work.stage = wordOf(job.push);
  work.doing = fmt::format("{} {} by {}", work.stage, options.volume, options.map);
  work.blocks = [&] {
    if (!job.push) return voxelBlocks(job.to(), job.output());
    return pushBlocks(job.map, job.from(), job.grids, pushSettings(job), job.to(), job.output());
  };
  work.make = blockMaker(job, context);
  work.memory = carryBlockMemory(job.from(), job.grids, job.carry, job.push);
  work.joinMemory = job.need().bytes;
  work.making = phases;
  work.joining = {phases.back(), phases.back()};
  return work;
}

// Peak need in bytes of carrying geometry, beyond what its file takes.
std::uint64_t carrierMemory(bool push, const Solid& source, const OutsideSettings& outside) {
  return push ? levelSetMemory(source, {}) : carryMemory(source, {}, {}, outside, {}, {false, 0});
}

void runGeometry(bool push, const CarryOptions& options, Context& context) {
  const MappedSolid mapped = readMapFile(options.map, context);
  const OutsideSettings outside =
      outsideSettings(options.transfer.outside, fadeTo(options.transfer), mapped);
  const std::uint64_t need =
      geometryMemory(options.volume) + carrierMemory(push, mapped.solid(), outside);
  if (!context.begins({fmt::format("{} {} by {}", wordOf(push), options.volume, options.map),
                       "write " + options.output},
                      {"carrying " + options.volume, need, "cut the file into parts"}))
    return;
  const auto file = readGeometryFile(options.volume, options.geometry, context);
  const SolidMap map = mapOf(options, mapped, context);
  const PointCarry carry = context.timed(push ? "level set" : "invert",
                                         [&] { return pointCarry(map, mapped, push, outside); });
  const PointCarry whole = fromInput(carry, context);
  const CarryGeometrySettings how =
      carryGeometrySettings(mapped, push, options.geometry.subdivide, options.geometry.splats);
  const CarriedGeometry carried =
      context.timed("carry", [&] { return carryGeometry(*file, whole, how); });
  warnOf(carried, options.transfer, "", context);
  context.detail(reportGeometry(carried, context));
  context.judge(judgeMap(mapped, nullptr, options.verdict, MapOrigin::file));
  writeGeometryFile(options.output, *file, carried, context);
}

void run(bool toTarget, const CarryOptions& options, Context& context) {
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
  if (geometry) return runGeometry(toTarget, options, context);
  const CarryJob job = read(toTarget, options, context);
  const std::vector<JobPhase> phases = carryingPhases(job);
  context.expect(phases);
  if (madeInShares(options.farm, blockWork(job, options, phases, context), context)) return;
  if (!context.begins({fmt::format("{} {} grids of {} by {}", wordOf(job.push), job.grids.size(),
                                   options.volume, options.map),
                       "write " + options.output},
                      job.need()))
    return;
  noteVoxelSize(job, context);
  const openvdb::GridPtrVec grids = (job.push ? push : pull)(job, options, context);
  context.judge(judgeMap(*job.mapped, nullptr, options.verdict, MapOrigin::file));
  describeMap(grids, *job.mapped);
  writeGridFile(options.output, grids, options.transfer.names, context);
}

// inputSpace: where the grids live.
Command makeCarryCommand(bool push, const std::string& summary, const std::string& inputSpace) {
  auto o = std::make_shared<CarryOptions>();
  Command c(wordOf(push), summary);
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
  c.run([o, push](Context& context) { run(push, *o, context); });
  return c;
}

}  // namespace

Command makePushCommand() {
  Command c = makeCarryCommand(
      true, "Carry grids or geometry inside a map's source solid to its target", "source");
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
      false, "Bring grids or geometry inside a map's target back to its source solid", "target");
  c.description(
      "Each voxel p of the source gets the grids' values at f(p), where the map brings it. "
      "Otherwise pull works like push, in the other direction.");
  c.example("innermap pull map.ply posed.vdb -o rest.vdb");
  c.example("innermap pull map.ply posed.obj -o bones.obj");
  return c;
}

}  // namespace innermap::tool
