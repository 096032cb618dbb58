#include "evaluation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "innermap/core/error.h"
#include "innermap/core/memory.h"
#include "innermap/io/vdb/vdb_file.h"
#include "innermap/levelset/level_set.h"
#include "largest.h"
#include "saved_map.h"

namespace innermap::tool {
namespace {

constexpr double kBand = 3;  // voxels: the skin of 2 and one more for interpolation

LevelSetSettings levelSetSettings(const EvaluationOptions& options, std::uint64_t maxMemory,
                                  Progress* progress) {
  LevelSetSettings settings;
  settings.resolution = options.resolution;
  settings.voxelSize = options.voxelSize.value_or(0);
  settings.halfWidth = kBand;
  settings.maxMemory = maxMemory;
  settings.progress = progress;
  return settings;
}

void fillReport(const MapGrids& grids, double voxelSize, const EvaluationOptions& options,
                Report& report) {
  ReportEnergy energy;
  energy.harmonic = grids.harmonicTotal;
  energy.deformation = grids.deformationTotal;
  report.energy = energy;
  report.set("energy.deformation_mean",
             grids.volume > 0 ? grids.deformationTotal / grids.volume : 0.0);
  report.set("energy.lame_lambda", options.lame.lambda);
  report.set("energy.lame_mu", options.lame.mu);
  ReportJacobian jacobian;
  jacobian.min = grids.jacobianMin;
  jacobian.max = grids.jacobianMax;
  jacobian.foldedFraction = grids.foldedFraction;
  report.jacobian = jacobian;
  ReportGrid grid;
  grid.voxelSize = voxelSize;
  grid.activeVoxels = grids.activeVoxels;
  grid.interiorVoxels = grids.interiorVoxels;
  report.grid = grid;
  report.set("grid.volume", grids.volume);
}

void describe(const openvdb::GridPtrVec& grids, const MapGrids& totals, const FieldFile& file,
              const EvaluationOptions& options) {
  describeMap(grids, file);
  for (const openvdb::GridBase::Ptr& grid : grids) {
    const auto number = [&grid](const char* key, double value) {
      grid->insertMeta(std::string("innermap_") + key, openvdb::DoubleMetadata(value));
    };
    number("harmonic_energy_total", totals.harmonicTotal);
    number("deformation_energy_total", totals.deformationTotal);
    number("jacobian_min", totals.jacobianMin);
    number("jacobian_max", totals.jacobianMax);
    number("folded_fraction", totals.foldedFraction);
    number("lame_lambda", options.lame.lambda);
    number("lame_mu", options.lame.mu);
  }
}

}  // namespace

void addEvaluationOptions(Command& command, EvaluationOptions& o) {
  command.option("--resolution", "N", &o.resolution, "voxels along the longest side of the solid")
      .range(4, 4096);
  command.option("--voxel-size", "L", &o.voxelSize, "edge of a voxel, in place of --resolution")
      .unit("world units")
      .above(0)
      .defaults("by --resolution");
  command.option("--lame-lambda", "X", &o.lame.lambda, "first elastic constant").range(0, 1e12);
  command.option("--lame-mu", "X", &o.lame.mu, "second elastic constant (shear)").range(0, 1e12);
  command.option("--names", "SCHEME", &o.names, "what the grids are called in the file")
      .choices({"innermap", "blender", "houdini"});
}

std::uint64_t evaluationMemory(const Solid& solid, const EvaluationOptions& options) {
  const LevelSetSettings settings = levelSetSettings(options, 0, nullptr);
  const double voxel = voxelSizeFor(solid, settings);
  // Leaves of 8^3 voxels are allocated whole: along the surface they reach about 6 voxels to either
  // side. 25 bytes a voxel of values, 8 of fog and masks.
  const double voxels = solid.volume() / std::pow(voxel, 3) + 12 * solid.area() / (voxel * voxel);
  return levelSetMemory(solid, settings) + static_cast<std::uint64_t>(33 * voxels);
}

void requireEvaluationMemory(const Solid& solid, const EvaluationOptions& options,
                             const Context& context) {
  const auto fits = [&](std::uint64_t resolution) {
    EvaluationOptions o = options;
    o.voxelSize.reset();
    o.resolution = static_cast<int>(resolution);
    return evaluationMemory(solid, o) <= context.maxMemory();
  };
  const std::uint64_t most = largestThat(4, 4096, fits);
  requireMemory("evaluating the map on a grid", evaluationMemory(solid, options),
                context.maxMemory(),
                most > 0 ? fmt::format("use --resolution {} or raise --max-memory", most)
                         : "raise --max-memory");
}

openvdb::GridPtrVec evaluateGrids(const BoundaryPair& pair, const FieldFile& file,
                                  const EvaluationOptions& options, Context& context) {
  const LevelSetSettings settings =
      levelSetSettings(options, context.maxMemory(), context.progress());
  if (!options.voxelSize && voxelSizeFor(pair.solid, settings) == kSmallestVoxel)
    context.note(
        fmt::format("the voxels are {} world units, the smallest that OpenVDB can hold, "
                    "not as small as --resolution asks for; scale the meshes up for more",
                    kSmallestVoxel));
  openvdb::FloatGrid::Ptr surface, density;
  context.timed("voxelize", [&] {
    surface = makeLevelSet(pair.solid, settings);
    density = makeFog(*surface);
    for (const std::string& warning : checkLevelSet(*surface, pair.solid).warnings)
      context.warning(warning);
  });
  MapGrids grids;
  context.timed("evaluate", [&] {
    EvaluateSettings evaluate;
    evaluate.lame = options.lame;
    evaluate.targetVolume = pair.targetVolume;
    evaluate.accuracy = sumAccuracy(file);
    evaluate.maxMemory = context.maxMemory();
    evaluate.progress = context.progress();
    grids = evaluateMap(HarmonicMap(file.field), pair.solid, *surface, evaluate);
  });
  if (grids.interiorVoxels == 0)
    throw DataError(pair.source.name +
                    ": is thinner than the voxels everywhere, none has its centre inside; use a "
                    "higher --resolution");
  openvdb::GridPtrVec all{surface, density};
  for (const openvdb::GridBase::Ptr& grid : grids.all()) all.push_back(grid);
  describe(all, grids, file, options);
  fillReport(grids, surface->voxelSize()[0], options, context.report());
  return all;
}

void writeGrids(const std::string& path, const openvdb::GridPtrVec& grids,
                const EvaluationOptions& options, Context& context) {
  VdbWriteSettings settings;
  settings.names = parseNamingScheme("--names", options.names);
  settings.progress = context.progress();
  writeVdb(path, grids, {}, settings);
}

std::string evaluationText(const Report& report) {
  if (!report.energy || !report.jacobian || !report.grid) return "";
  return fmt::format(
      "energy: harmonic {:.6g}, deformation {:.6g}\n"
      "jacobian: {:.4g} to {:.4g}, folded {:.3g}% of the volume\n"
      "grid: {} active voxels of {:.6g}\n",
      report.energy->harmonic, report.energy->deformation, report.jacobian->min,
      report.jacobian->max, 100 * report.jacobian->foldedFraction, report.grid->activeVoxels,
      report.grid->voxelSize);
}

}  // namespace innermap::tool
