#include "grid_options.h"

#include "innermap/core/memory.h"
#include "report/page/page.h"

namespace innermap::tool {

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

}  // namespace innermap::tool
