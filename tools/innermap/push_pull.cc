// `innermap push` and `innermap pull`: grids and geometry carried through a map, and back.
#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "commands.h"
#include "geometry_transfer.h"
#include "innermap/core/memory.h"
#include "innermap/io/cell_file.h"
#include "innermap/tetra/cells.h"
#include "innermap/transfer/carry.h"
#include "inputs.h"
#include "job_cost.h"
#include "report/report_figures.h"
#include "transfer_options.h"

namespace innermap::tool {
namespace {

enum class Way { push, pull };

struct CarryOptions {
  std::string map, volume, output, through;
  VerdictSettings verdict;
  TransferOptions transfer;
  GeometryOptions geometry;
};

// What both read.
struct Job {
  MappedSolid mapped;
  Solid target;
  OutsideSettings outside;
  openvdb::GridPtrVec grids;
  std::optional<ThroughMap> through;
};

LinearCellMap readThrough(const std::string& path, const MappedSolid& mapped, Context& context) {
  const CellMesh mesh = context.timed("read", [&] { return readCells(path).mesh; });
  return linearMapOf(mesh, mapped);
}

Job read(const CarryOptions& options, Context& context) {
  MappedSolid mapped = readMapFile(options.map, context);
  const OutsideSettings outside = outsideSettings(
      options.transfer, mapped.solid().repaired().mesh.vertices, mapped.boundary.target.moved);
  openvdb::GridPtrVec grids = readVolume(options.volume, options.transfer, context);
  Solid target = targetSolid(mapped, context);
  std::optional<ThroughMap> through;
  if (!options.through.empty()) through = throughMap(readThrough(options.through, mapped, context));
  return {std::move(mapped), std::move(target), outside, std::move(grids), std::move(through)};
}

double growthOf(Way way, const Job& job) {
  const double from = job.mapped.solid().volume(), to = job.target.volume();
  return way == Way::push ? voxelGrowth(from, to) : voxelGrowth(to, from);
}

void expectCarrying(Way way, const Job& job, const TransferOptions& options, double growth,
                    Context& context) {
  const std::size_t charges = job.mapped.map.sources();
  const double asGiven = finestVoxel(job.grids);
  const auto sizeOf = [&](const Solid& solid, const LevelSetSettings& settings) {
    return jobSize(solid, settings, charges);
  };
  LevelSetSettings given;
  given.voxelSize = asGiven;
  const Solid& source = job.mapped.solid();
  const Solid& to = way == Way::push ? job.target : source;
  JobSize made = sizeOf(to, outputSettings(job.grids, options.grid, growth));
  made.items = static_cast<double>(job.grids.size()) * made.inside;
  const JobSize from = sizeOf(way == Way::push ? source : job.target, given);
  JobPhase levelSets = stageOf("level set", made, 2);
  levelSets.seconds = (levelSets.seconds + stageOf("level set", from, 2).seconds) / 2;
  std::vector<JobPhase> phases = {levelSets};
  const CarrySettings carry = carrySettings(options);
  std::size_t densities = 0;
  for (const openvdb::GridBase::Ptr& grid : job.grids) densities += isDensity(*grid, carry);
  if (way == Way::pull) {
    phases.push_back(stageOf("pulling the grids", made));
  } else {
    if (densities < job.grids.size()) {
      phases.push_back(stageOf("covering the target", made));
      phases.push_back(stageOf("inverting the map", made));
      phases.push_back(stageOf("carrying the grids", made));
    }
    if (densities > 0) {
      JobSize held = from;
      held.items = static_cast<double>(densities) * from.inside;
      phases.push_back(stageOf("finding the inside", held));
      phases.push_back(stageOf("mapping the densities", held));
      phases.push_back(stageOf("carrying the densities", held));
    }
  }
  phases.push_back(stageOf("writing the VDB file", made));
  context.expect(phases);
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

openvdb::GridPtrVec push(const Job& job, const TransferOptions& options, Context& context) {
  PushSettings settings;
  settings.carry = carrySettings(options);
  settings.outside = job.outside;
  settings.accuracy = sumAccuracy(job.mapped);
  settings.through = job.through ? &*job.through : nullptr;
  const openvdb::FloatGrid::Ptr levelSet =
      outputLevelSet(job.target, job.grids, options, context, growthOf(Way::push, job));
  const PushResult result = context.timed("push", [&] {
    return VolumePusher(job.mapped.solid(), job.grids, settings).push(job.mapped.map, *levelSet);
  });
  reportPush(result, context);
  context.detail(pushText(result));
  const double volumes = volumeRatio(job.mapped.solid().volume(), job.target.volume());
  for (const CarriedMass& mass : result.masses)
    context.judge(judgeDensity(
        {mass.name, "", std::min(mass.largestRatio, settings.carry.densityLimit), volumes},
        options.verdict));
  context.judge(judgeResampling(result.resampling, options.verdict));
  return result.grids;
}

openvdb::GridPtrVec pull(const Job& job, const TransferOptions& options, Context& context) {
  PullSettings settings;
  settings.carry = carrySettings(options);
  settings.outside = job.outside;
  settings.accuracy = sumAccuracy(job.mapped);
  settings.through = job.through ? &*job.through : nullptr;
  const TransferOptions plain;  // the target's level set is none of the output's
  const openvdb::FloatGrid::Ptr target = outputLevelSet(job.target, job.grids, plain, context);
  settings.targetLevelSet = target.get();
  const Solid& source = job.mapped.solid();
  const openvdb::FloatGrid::Ptr levelSet =
      outputLevelSet(source, job.grids, options, context, growthOf(Way::pull, job));
  const PullResult result = context.timed(
      "pull", [&] { return pullGrids(job.mapped.map, source, *levelSet, job.grids, settings); });
  for (const std::string& warning : result.warnings) context.warning(warning);
  context.report().add("pull", pulledFigures(result.voxels));
  context.detail(fmt::format("pulled {} grids, {} voxels\n", result.grids.size(), result.voxels));
  const double volumes = volumeRatio(job.target.volume(), source.volume());
  for (const openvdb::GridBase::Ptr& grid : job.grids)
    if (result.resampling.largestGrowth > 0 && isDensity(*grid, settings.carry))
      context.judge(judgeDensity(
          {grid->getName(), "",
           std::min(result.resampling.largestGrowth, settings.carry.densityLimit), volumes},
          options.verdict));
  context.judge(judgeResampling(result.resampling, options.verdict));
  return result.grids;
}

// Peak need in bytes of carrying geometry, beyond what its file takes.
std::uint64_t carrierMemory(Way way, const Solid& source, const OutsideSettings& outside) {
  return way == Way::push ? levelSetMemory(source, {})
                          : carryMemory(source, {}, {}, outside, {}, {false, 0});
}

PointCarry carryOf(Way way, const MappedSolid& mapped, const CarryPointsSettings& settings,
                   Context& context) {
  if (way == Way::push) {
    const PointPusher pusher =
        context.timed("level set", [&] { return PointPusher(mapped.solid(), settings); });
    return [=, map = mapped.map](const Points& points, bool jacobians) {
      return pusher.push(map, points, jacobians);
    };
  }
  const Solid target = targetSolid(mapped, context);
  const PointPuller puller = context.timed(
      "invert", [&] { return PointPuller(mapped.map, mapped.solid(), target, settings); });
  return [=](const Points& points, bool jacobians) { return puller.pull(points, jacobians); };
}

void runGeometry(Way way, const CarryOptions& options, Context& context) {
  const MappedSolid mapped = readMapFile(options.map, context);
  const Points& moved = mapped.boundary.target.moved;
  const OutsideSettings outside =
      outsideSettings(options.transfer, mapped.solid().repaired().mesh.vertices, moved);
  const std::uint64_t need =
      geometryMemory(options.volume) + carrierMemory(way, mapped.solid(), outside);
  if (context.dryRun())
    return context.plan({fmt::format("{} {} by {}", way == Way::push ? "push" : "pull",
                                     options.volume, options.map),
                         "write " + options.output},
                        need);
  context.requireMemory("carrying " + options.volume, need, "cut the file into parts");
  const auto file = readGeometryFile(options.volume, options.geometry, context);
  const CarryPointsSettings settings = carryPointsSettings(outside, sumAccuracy(mapped));
  const PointCarry carry =
      options.through.empty()
          ? carryOf(way, mapped, settings, context)
          : carryThrough(readThrough(options.through, mapped, context), way == Way::push, settings);
  const PointCarry whole = fromInput(carry, context);
  const double diagonal =
      way == Way::push ? boundingBox(moved).diagonal() : mapped.solid().diagonal();
  const CarryGeometrySettings how{options.geometry.subdivide * diagonal, options.geometry.splats,
                                  mapped.injectivity.mirrored};
  const CarriedGeometry carried =
      context.timed("carry", [&] { return carryFile(*file, whole, how, context); });
  warnOf(*file, carried, options.transfer, "", context);
  context.detail(reportGeometry(*file, carried, context));
  context.judge(judgeMap(mapped, nullptr, options.verdict, MapOrigin::file));
  writeGeometryFile(options.output, *file, carried, context);
}

void run(Way way, const CarryOptions& options, Context& context) {
  requireFitting(options.volume, options.output, options.transfer, options.geometry);
  context.output(options.output);
  if (isGeometryFile(options.volume)) return runGeometry(way, options, context);
  const Job job = read(options, context);
  const Solid& solid = way == Way::push ? job.target : job.mapped.solid();
  const double growth = growthOf(way, job);
  const CarryKind kind{way == Way::push, 0};
  expectCarrying(way, job, options.transfer, growth, context);
  if (context.dryRun())
    return context.plan({fmt::format("{} {} grids of {} by {}", way == Way::push ? "push" : "pull",
                                     job.grids.size(), options.volume, options.map),
                         "write " + options.output},
                        transferMemory(solid, job.grids, options.transfer, kind, growth));
  requireTransferMemory(solid, job.grids, options.transfer, context, kind, growth);
  noteVoxelSize(job.grids, options.transfer, growth, context);
  const openvdb::GridPtrVec grids =
      (way == Way::push ? push : pull)(job, options.transfer, context);
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
           "result agrees with the mesh and folds nowhere; not for densities")
      .reads();
  addTransferOptions(c, o->transfer);
  addGeometryOptions(c, o->geometry, true);
  c.settings(describe(o->verdict));
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
