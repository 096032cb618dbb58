#include "grid_options.h"

#include <fmt/format.h>

#include "html/page.h"
#include "innermap/core/memory.h"

namespace innermap::tool {
namespace {

constexpr int kLeast = 4, kMost = 4096;  // voxels along the longest side

}  // namespace

void addGridOptions(Command& c, GridOptions& o, const std::string& of,
                    const std::string& defaults) {
  c.option("--resolution", "N", &o.resolution, "voxels along the longest side of " + of)
      .range(kLeast, kMost)
      .defaults(defaults);
  c.option("--voxel-size", "LENGTH", &o.voxelSize, "edge of a voxel, in place of --resolution")
      .unit("world units")
      .above(0)
      .defaults("by --resolution");
}

void requireGridMemory(const std::string& doing, const GridOptions& options, const Context& context,
                       const std::function<std::uint64_t(const GridOptions&)>& need) {
  const auto needAt = [&](std::uint64_t resolution) {
    GridOptions other;
    other.resolution = static_cast<int>(resolution);
    return need(other);
  };
  context.requireMemory(doing, need(options), {"--resolution", kLeast, kMost, needAt},
                        "raise --max-memory");
}

void addNamesOption(Command& command, NamingScheme& names) {
  command.choice("--names", "SCHEME", &names,
                 {{"innermap", NamingScheme::innermap},
                  {"blender", NamingScheme::blender},
                  {"houdini", NamingScheme::houdini}},
                 "what the grids are called in the file");
}

void writeGridFile(const std::string& path, const openvdb::GridPtrVec& grids,
                   const NamingScheme& names, Context& context, const openvdb::MetaMap& metadata) {
  if (context.page()) addGrids(*context.page(), grids);
  VdbWriteSettings settings;
  settings.names = names;
  context.timed("write", [&] { writeVdb(path, grids, metadata, settings); });
}

void addEvaluationOptions(Command& c, EvaluationOptions& o) {
  c.group("grids");
  addGridOptions(c, o.grid);
  c.option("--lame-lambda", "X", &o.lame.lambda, "first elastic constant")
      .range(0, 1e12)
      .advanced();
  c.option("--lame-mu", "X", &o.lame.mu, "second elastic constant (shear)")
      .range(0, 1e12)
      .advanced();
  c.choice("--repair", "WHEN", &o.repair,
           {{"auto", RepairFolds::automatic}, {"on", RepairFolds::on}, {"off", RepairFolds::off}},
           "take folds out of the grids, where `repaired` says how far voxels were moved; auto: "
           "where at most 0.5% of the voxels is folded")
      .advanced();
  addNamesOption(c, o.names);
}

MapGridSettings mapGridSettings(const EvaluationOptions& options) {
  auto settings = gridSettings<MapGridSettings>(options.grid);
  settings.lame = options.lame;
  settings.repair = options.repair;
  return settings;
}

void requireEvaluationMemory(const Solid& solid, const GridOptions& options, const Context& context,
                             const MapGridKind& kind) {
  requireGridMemory("evaluating the map on a grid", options, context, [&](const GridOptions& o) {
    return mapGridMemory(solid, gridSettings<MapGridSettings>(o), kind);
  });
}

}  // namespace innermap::tool
