#include "grid_options.h"

#include "innermap/core/memory.h"
#include "report/page/page.h"

namespace innermap::tool {
void requireGridMemory(const std::string& doing, const LatticeChoice& options,
                       const Context& context,
                       const std::function<std::uint64_t(const LatticeChoice&)>& need) {
  const auto needAt = [&](std::uint64_t resolution) {
    LatticeChoice other;
    other.resolution = static_cast<int>(resolution);
    return need(other);
  };
  context.requireMemory(doing, need(options), {"--resolution", kLeastVoxels, kMostVoxels, needAt},
                        "raise --max-memory");
}

void writeGridFile(const std::string& path, const openvdb::GridPtrVec& grids,
                   const NamingScheme& names, Context& context, const openvdb::MetaMap& metadata) {
  if (context.page()) addGrids(*context.page(), grids);
  VdbWriteSettings settings;
  settings.names = names;
  if (context.space().given()) sayInGrids(grids, context.space());
  context.timed("write", [&] { writeVdb(path, grids, metadata, settings); });
}

void addEvaluationOptions(Command& c, EvaluationOptions& o) {
  c.group("grids");
  c.settings(describe(o.grid));
  c.settings(describe(o.lame));
  c.setting(repairSetting(&o.repair));
  c.setting(namesSetting(&o.names));
}

MapGridSettings mapGridSettings(const EvaluationOptions& options) {
  auto settings = options.grid.in<MapGridSettings>();
  settings.lame = options.lame;
  settings.repair = options.repair;
  return settings;
}

void requireEvaluationMemory(const Solid& solid, const LatticeChoice& options,
                             const Context& context, const MapGridKind& kind) {
  requireGridMemory("evaluating the map on a grid", options, context, [&](const LatticeChoice& o) {
    return mapGridMemory(solid, o.in<MapGridSettings>(), kind);
  });
}

}  // namespace innermap::tool
